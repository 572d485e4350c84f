import { VisuallyHidden } from "@mantine/core";
import css from "./console.module.css";
import { FIELD_WORDS, type FieldBytes } from "./frames";

/** A frame's bytes, each field in its colour with its name below. */
export function Bytes({ label, fields }: { label: string; fields: readonly FieldBytes[] }) {
  return (
    <div className={css.bytes}>
      <VisuallyHidden>{label}</VisuallyHidden>
      <span className={css.direction} aria-hidden>
        {label === "request" ? "→" : "←"}
      </span>
      {fields.map((field, index) => (
        <span
          // biome-ignore lint/suspicious/noArrayIndexKey: the fields of one frame never change places
          key={index}
          className={css.fieldBytes}
          data-kind={field.kind}
          data-wrong={field.kind === "checksum" && field.meaning === "wrong"}
          title={`${FIELD_WORDS[field.kind]}: ${field.meaning}`}
        >
          <span className={css.hex}>{field.bytes.join(" ")}</span>
          <span className={css.fieldWord}>{FIELD_WORDS[field.kind]}</span>
        </span>
      ))}
    </div>
  );
}
