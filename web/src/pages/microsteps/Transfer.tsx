import { Copy, Paste } from "./Paste";
import { cArray, hexList, parseTable } from "./table";

interface Props {
  values: readonly number[] | null;
  onPaste: (values: number[]) => void;
}

/** Out of the page as datagrams or C, into it as 64 numbers. */
export function Transfer({ values, onPaste }: Props) {
  return (
    <>
      <Copy label="Datagrams" text={values ? hexList(values) : ""} />
      <Copy label="C array" text={values ? cArray(values) : ""} />
      <Paste
        what="table"
        help="64 numbers of 0 to 63, separated by spaces, commas or lines; a C array; or the 32 datagrams."
        use="Use these values"
        parse={parseTable}
        onPaste={(read) => onPaste(read.values)}
      />
    </>
  );
}
