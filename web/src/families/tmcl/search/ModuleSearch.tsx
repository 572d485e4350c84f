import { Button, Group, Select, Switch, Text } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import type { Schemas } from "../../../api/client";
import { type AxisAddress, motion } from "../../../api/motion";
import type { Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import classes from "../../../pages/bench/bench.module.css";
import { SearchProgress } from "../../../pages/bench/motion/SearchProgress";
import { SearchSteps } from "../../../pages/bench/motion/SearchSteps";
import { setZero } from "../../../pages/bench/motion/setZero";
import type { Action } from "../../../pages/bench/motion/useAction";
import { searchKey, useSearch } from "../../../pages/bench/motion/useSearch";
import { useParameters } from "../../../pages/module/useParameters";
import { type BaseMode, type Choice, choiceOf, codeOf, extraOf, openOf, stepsOf, titleOf } from "./searchModes";

const BASES: readonly BaseMode[] = [1, 2, 3, 4, 5, 6, 7, 8];
const MODE = "reference_search_mode";
const FAST = "reference_search_speed";
const SLOW = "reference_switch_speed";
const NAMES = [MODE, FAST, SLOW] as const;
const SPEED_MAX = 7_999_774;

interface Props {
  at: AxisAddress;
  device: Device;
  action: Action;
  disabled: boolean;
}

/** The module's own reference search: its modes, its two speeds, what it does now and what it found. */
export function ModuleSearch({ at, device, action, disabled }: Props) {
  const queries = useQueryClient();
  const search = useSearch(at, !disabled);
  const parameters = useParameters(at, NAMES, !disabled);
  const [chosen, setChosen] = useState<Choice | null>(null);
  const [speeds, setSpeeds] = useState<{ fast: number | null; slow: number | null }>({ fast: null, slow: null });
  const running = search.data?.state === "running";
  const held = choiceOf(parameters.held(MODE) ?? 0);
  const choice = (running ? choiceOf(search.data?.mode ?? 0) : null) ??
    chosen ??
    held ?? { base: 1, mirrored: false, inverted: false };
  const extra = extraOf(choice.base);
  const fast = speeds.fast ?? parameters.held(FAST);
  const slow = speeds.slow ?? parameters.held(SLOW);
  const locked = disabled || running;
  const start: Schemas["ReferenceSearchStart"] = {
    mode: codeOf(choice) as NonNullable<Schemas["ReferenceSearchStart"]["mode"]>,
    // null: as the module holds it; 0 there means that nobody has set it yet
    search_speed_pps: speeds.fast,
    switch_speed_pps: speeds.slow,
  };
  const refresh = () => {
    void queries.invalidateQueries({ queryKey: searchKey(at) });
    void queries.invalidateQueries({ queryKey: ["emulator", at.device] });
    void queries.invalidateQueries({ queryKey: ["parameters", at.device] });
  };
  const speed = (label: string, key: "fast" | "slow", value: number | null) => (
    <NumberField
      classNames={{ root: classes.inline, input: "num" }}
      label={label}
      value={value}
      placeholder="unknown"
      unit="pps"
      min={1}
      max={SPEED_MAX}
      step={1000}
      disabled={locked}
      onChange={(next) => setSpeeds((now) => ({ ...now, [key]: next }))}
      data-testid={`search-${key}`}
    />
  );
  return (
    <>
      <Select
        aria-label="Reference search mode, AP 193"
        data={BASES.map((base) => ({
          value: String(base),
          label: `${base}  ${titleOf({ base, mirrored: choice.mirrored, inverted: false })}`,
        }))}
        value={String(choice.base)}
        disabled={locked}
        comboboxProps={{ width: "max-content", position: "bottom-start" }}
        onChange={(value) => value && setChosen({ ...choice, base: Number(value) as BaseMode })}
        data-testid="search-mode"
      />
      <Switch
        size="sm"
        label={extra === "mirrored" ? "left and right exchanged (+64)" : "home switch inverted (+128)"}
        checked={choice[extra]}
        disabled={locked}
        onChange={(event) => setChosen({ ...choice, [extra]: event.currentTarget.checked })}
        data-testid="search-extra"
      />
      {speed("Search", "fast", fast)}
      {speed("Switch", "slow", slow)}
      <SearchSteps steps={stepsOf(choice)} />
      {openOf(choice) !== "" && (
        <Text size="xs" c="dimmed">
          {openOf(choice)}
        </Text>
      )}
      <SearchProgress
        search={search.data}
        label="Reference search"
        testId="search-state"
        idle="The module searches by itself; it does not need this page."
        running={({ phase }) => phase || "searching"}
        done={({ message }) => message || "Found: the counter is zero there."}
      />
      <dl className="facts pairs m-0 text-12">
        <dt>End switches apart, AP 196</dt>
        <dd className="num" data-testid="search-distance">
          {fixed(search.data?.distance)}
        </dd>
        <dt>Zero lay at, AP 197</dt>
        <dd className="num" data-testid="search-last">
          {fixed(search.data?.last_position)}
        </dd>
      </dl>
      <Group gap={6} grow wrap="nowrap">
        <Button
          disabled={disabled}
          color={running ? "red" : "accent"}
          data-testid="reference-search"
          onClick={() =>
            void action
              .run(running ? "Ending the search" : "Starting the search", () =>
                running ? motion.endSearch(at) : motion.search(at, start),
              )
              .then(refresh)
          }
        >
          {running ? "Abort" : "Search"}
        </Button>
        <Button
          variant="default"
          disabled={locked}
          title="Calls the present position 0; the motor does not move"
          data-testid="set-zero"
          onClick={() => void action.run("Setting zero", () => setZero(at, device)).then(refresh)}
        >
          Set zero here
        </Button>
      </Group>
    </>
  );
}
