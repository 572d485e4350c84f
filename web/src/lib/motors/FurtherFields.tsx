import { NumberField } from "../NumberField";
import { FURTHER, type FurtherFigures, shifted } from "./figures";

interface Props {
  figures: FurtherFigures;
  set: (change: Partial<FurtherFigures>) => void;
  onWrong: (field: string) => (wrong: boolean) => void;
}

/** What may be known of a motor beside its plate, in the units of data sheets; each may be left empty. */
export function FurtherFields({ figures, set, onWrong }: Props) {
  return FURTHER.map(({ key, powers, ...field }) => {
    const value = figures[key];
    return (
      <NumberField
        key={key}
        {...field}
        placeholder="not known"
        value={value === null ? null : shifted(value, powers)}
        onChange={(typed) => set({ [key]: shifted(typed, -powers) })}
        onClear={() => set({ [key]: null })}
        onWrong={onWrong(key)}
      />
    );
  });
}
