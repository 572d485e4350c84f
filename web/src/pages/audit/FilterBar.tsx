import { Button, NativeSelect, TextInput } from "@mantine/core";
import { useHotkeys } from "@mantine/hooks";
import { IconDownload, IconSearch } from "@tabler/icons-react";
import { useRef } from "react";
import { optionsOf } from "../../lib/choices";
import classes from "./audit.module.css";
import { csvHref, EVERYTHING, type Filters, isFiltered, type Query, type Span } from "./filters";
import { useAuditFilters } from "./useAudit";

const SPANS: { value: Span; label: string }[] = optionsOf({
  any: "any time",
  "15 min": "last 15 min",
  hour: "last hour",
  day: "last 24 hours",
  week: "last 7 days",
  between: "between…",
});

interface Props {
  filters: Filters;
  query: Query;
  onChange: (filters: Filters) => void;
}

/** Words to look for, and what to look at. */
export function FilterBar({ filters, query, onChange }: Props) {
  const known = useAuditFilters();
  const search = useRef<HTMLInputElement>(null);
  useHotkeys([["/", () => search.current?.focus()]]);
  const set = (change: Partial<Filters>) => onChange({ ...filters, ...change });
  return (
    <search className="row wrap gap-6 mb-8">
      <TextInput
        ref={search}
        type="search"
        className={classes.search ?? ""}
        aria-label="Search the audit log"
        placeholder="a register, a value, a reason"
        leftSection={<IconSearch size={14} aria-hidden />}
        value={filters.text}
        onChange={(event) => set({ text: event.currentTarget.value })}
      />
      <Choice
        label="Device"
        all="every device"
        names={known.devices}
        value={filters.device}
        onPick={set}
        name="device"
      />
      <Choice label="Who" all="everybody" names={known.who} value={filters.who} onPick={set} name="who" />
      <Choice
        label="Action"
        all="every action"
        names={known.actions}
        value={filters.action}
        onPick={set}
        name="action"
      />
      <Choice
        label="Outcome"
        all="any outcome"
        names={["done", "not proven", "refused"]}
        value={filters.outcome}
        onPick={set}
        name="outcome"
      />
      <NativeSelect
        aria-label="Time"
        data={SPANS}
        value={filters.span}
        onChange={(event) => set({ span: event.currentTarget.value as Span })}
      />
      {filters.span === "between" && (
        <span className="flex wrap gap-6">
          <TextInput
            type="datetime-local"
            step={1}
            aria-label="From"
            value={filters.from}
            onChange={(event) => set({ from: event.currentTarget.value })}
          />
          <TextInput
            type="datetime-local"
            step={1}
            aria-label="To"
            value={filters.to}
            onChange={(event) => set({ to: event.currentTarget.value })}
          />
        </span>
      )}
      <Button variant="default" disabled={!isFiltered(filters)} onClick={() => onChange(EVERYTHING)}>
        Clear
      </Button>
      <Button
        component="a"
        href={csvHref(query)}
        download
        variant="default"
        leftSection={<IconDownload size={14} aria-hidden />}
      >
        CSV
      </Button>
    </search>
  );
}

interface ChoiceProps {
  label: string;
  all: string;
  names: readonly string[];
  value: string;
  name: keyof Filters;
  onPick: (change: Partial<Filters>) => void;
}

function Choice({ label, all, names, value, name, onPick }: ChoiceProps) {
  const data = [{ value: "", label: all }, ...(value === "" || names.includes(value) ? names : [value, ...names])];
  return (
    <NativeSelect
      aria-label={label}
      className={classes.choice ?? ""}
      data={data}
      value={value}
      onChange={(event) => onPick({ [name]: event.currentTarget.value })}
    />
  );
}
