import { NativeSelect } from "@mantine/core";
import type { FieldsProps } from "./kind";
import { SEEN_BY, type SeenBy } from "./seenBy";

/** What tells of lost steps. */
export function SeenByField({ form, change }: Pick<FieldsProps<{ seenBy: SeenBy }>, "form" | "change">) {
  return (
    <NativeSelect
      label="Lost steps are seen by"
      data={SEEN_BY}
      value={form.seenBy}
      onChange={({ currentTarget }) => change({ seenBy: currentTarget.value as SeenBy })}
    />
  );
}
