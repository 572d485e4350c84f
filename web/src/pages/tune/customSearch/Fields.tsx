import { Autocomplete, Button, NativeSelect, Switch, Text } from "@mantine/core";
import { useState } from "react";
import { compact } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { DistanceField } from "../DistanceField";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import classes from "./customSearch.module.css";
import { type CustomSearchForm, FIGURES, presetOf, type Searchable, type Searched, type SearchedFigure } from "./form";
import { useSearchable } from "./useSearchable";

const SETTINGS_MAX = 8;
const SHOWN = 30;
const NUMBERS: readonly Asked<CustomSearchForm>[] = [
  { key: "timeMost", label: "Time at most", description: "empty: any", min: 0.001, unit: "s", optional: true },
  {
    key: "deviationMost",
    label: "Deviation at most",
    description: "empty: any",
    min: 0.001,
    unit: "full steps",
    optional: true,
  },
  { key: "repeats", label: "Moves there and back with each setting", min: 1, max: 20, integer: true },
  { key: "trials", label: "Settings tried at most", min: 1, max: 1000, integer: true },
];
const GOALS = Object.entries(FIGURES).map(([value, { label }]) => ({
  value,
  label: `${value === "load_min" ? "more" : "less"}: ${label}`,
}));

/** Settings with their ranges, the move, and what is to be better. */
export function Fields({ form, change, scale, axis }: FieldsProps<CustomSearchForm>) {
  const { data, error, refetch } = useSearchable(axis);
  const known = data?.settings ?? [];
  const put = (setting: Searched) =>
    change({ settings: form.settings.map((one) => (one.name === setting.name ? setting : one)) });
  return (
    <>
      <ProblemAlert error={error} doing="Reading what may be searched" retry={() => void refetch()} />
      {form.settings.map((setting) => (
        <Setting
          key={setting.name}
          setting={setting}
          about={known.find(({ name }) => name === setting.name)}
          put={put}
          remove={() => change({ settings: form.settings.filter(({ name }) => name !== setting.name) })}
        />
      ))}
      {form.settings.length < SETTINGS_MAX && (
        <Adding
          known={known.filter(({ name }) => form.settings.every((one) => one.name !== name))}
          first={form.settings.length === 0}
          add={(about) => change({ settings: [...form.settings, presetOf(about)] })}
        />
      )}
      <DistanceField form={form} change={change} scale={scale} label="Distance" />
      <NativeSelect
        label="What is to be better"
        data={GOALS}
        value={form.first}
        onChange={({ currentTarget }) => change({ first: currentTarget.value as SearchedFigure })}
      />
      <NativeSelect
        label="And besides"
        description="then a front of both is told, and neither may be worse"
        data={[{ value: "", label: "nothing" }, ...GOALS.filter(({ value }) => value !== form.first)]}
        value={form.second === form.first ? "" : form.second}
        onChange={({ currentTarget }) => change({ second: currentTarget.value as CustomSearchForm["second"] })}
      />
      <Numbers form={form} change={change} of={NUMBERS} />
      <Switch
        label="More current than now may be tried"
        checked={form.moreCurrent}
        onChange={({ currentTarget }) => change({ moreCurrent: currentTarget.checked })}
      />
    </>
  );
}

interface SettingProps {
  setting: Searched;
  about: Searchable | undefined;
  put: (setting: Searched) => void;
  remove: () => void;
}

/** One setting: from where to where, and by which steps. */
function Setting({ setting, about, put, remove }: SettingProps) {
  const { name, unit, low, high, log } = setting;
  return (
    <fieldset className={classes.setting}>
      <legend>{name}</legend>
      {about && (
        <Text size="sm" className="dim">
          {about.help}; now {compact(about.now, 6, unit)}, it takes {compact(about.low, 6)} to{" "}
          {compact(about.high, 6, unit)}.
        </Text>
      )}
      <div className={classes.range}>
        <NumberField
          label="From"
          value={low}
          unit={unit}
          max={high}
          onChange={(value) => put({ ...setting, low: value })}
        />
        <NumberField
          label="To"
          value={high}
          unit={unit}
          min={low}
          onChange={(value) => put({ ...setting, high: value })}
        />
      </div>
      <div className={classes.range}>
        <Switch
          label="By equal ratios"
          disabled={low <= 0}
          checked={log && low > 0}
          onChange={({ currentTarget }) => put({ ...setting, log: currentTarget.checked })}
        />
        <Button variant="default" size="compact-sm" onClick={remove}>
          Leave {name} out
        </Button>
      </div>
    </fieldset>
  );
}

interface AddingProps {
  known: readonly Searchable[];
  first: boolean;
  add: (about: Searchable) => void;
}

/** A further setting, found by a part of its name, its group or what it is for. */
function Adding({ known, first, add }: AddingProps) {
  const [text, setText] = useState("");
  const wanted = text.trim().toLowerCase();
  const fitting = known.filter(({ name, group, help }) => `${name} ${group} ${help}`.toLowerCase().includes(wanted));
  return (
    <Autocomplete
      label={first ? "Setting to be searched" : "And another setting"}
      description="a register field, a parameter, or a figure of the ramp"
      placeholder="ramp.acceleration, hysteresis, current …"
      data={fitting.map(({ name }) => name)}
      filter={({ options }) => options}
      value={text}
      onChange={setText}
      onOptionSubmit={(name) => {
        const about = known.find((one) => one.name === name);
        if (about) add(about);
        setTimeout(() => setText(""));
      }}
      limit={SHOWN}
      maxDropdownHeight={260}
    />
  );
}
