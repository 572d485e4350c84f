import { NumberField, type NumberFieldProps } from "../../lib/NumberField";

type KeyOfNumber<F> = { [K in keyof F]: F[K] extends number | null ? K : never }[keyof F] & string;

/** A number that a study is asked for. `optional`: it may be left empty. */
export interface Asked<F> extends Pick<NumberFieldProps, "min" | "max" | "unit" | "integer"> {
  key: KeyOfNumber<F>;
  label: string;
  description?: string;
  optional?: true;
}

/** Numbers of a form below each other. */
export function Numbers<F>(props: { form: F; change: (part: Partial<F>) => void; of: readonly Asked<F>[] }) {
  const set = (key: string, value: number | null) => props.change({ [key]: value } as Partial<F>);
  return props.of.map(({ key, optional, ...field }) => (
    <NumberField
      key={key}
      {...field}
      value={props.form[key] as number | null}
      onChange={(value) => set(key, value)}
      {...(optional && { onClear: () => set(key, null) })}
    />
  ));
}
