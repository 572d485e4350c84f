import { Text } from "@mantine/core";
import css from "./program.module.css";

/** Address, bytes, line and command of each, as the assembler lists them. */
export function Listing({ text, counter }: { text: string; counter: number | null }) {
  if (text === "") return <Text className="hint">A listing is there for a program without problems.</Text>;
  const rows = text.trimEnd().split("\n");
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: a long listing is scrolled with the keyboard, too
    <pre className={css.listing} tabIndex={0}>
      {rows.map((row, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: rows have no other name than their place
        <div key={index} data-current={counter !== null && row.startsWith(`${String(counter).padStart(5)}  `)}>
          {row || " "}
        </div>
      ))}
    </pre>
  );
}
