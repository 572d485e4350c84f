import { IconChevronRight } from "@tabler/icons-react";
import css from "./connections.module.css";
import { AxisTable, type Entry, FieldGroup } from "./fields";
import type { Field, Form } from "./form";

interface Props extends Entry {
  form: Form;
  /** of the axes */
  names: readonly string[];
  open: boolean;
  onOpen: (open: boolean) => void;
}

/** The fields of a link. Those of an emulator are folded away: its defaults are good. */
export function LinkFields({ form, names, open, onOpen, ...entry }: Props) {
  return (
    <>
      {form.fold !== undefined && (
        <button
          type="button"
          className={`${css.more} row gap-4 p-0 accent`}
          aria-expanded={open}
          onClick={() => onOpen(!open)}
        >
          <IconChevronRight size={13} className={css.chevron} data-open={open} aria-hidden />
          Emulator: {form.fold}
        </button>
      )}
      {(form.fold === undefined || open) &&
        form.groups.map((group) =>
          group.list === undefined ? (
            <FieldGroup key={group.title} group={group} {...entry} />
          ) : (
            <AxisTable
              key={group.title}
              group={group}
              rows={names.map((name, index) => ({
                id: `axis ${index}`,
                name,
                ...within(entry, `${group.list}.${index}`),
              }))}
            />
          ),
        )}
    </>
  );
}

/** The fields of one object in a list of an entry. */
function within({ value, problem, onChange }: Entry, place: string): Entry {
  const at = (field: Field) => ({ ...field, path: `${place}.${field.path}` });
  return {
    value: (field) => value(at(field)),
    problem: (field) => problem(at(field)),
    onChange: (field, text) => onChange(at(field), text),
  };
}
