import { parseNumber } from "../../lib/format";
import { type Json, type Limits, numberOf, numberProblem, over, said } from "./limits";
import { canModel, type Model } from "./models";

export interface OptionRow {
  key: string;
  label: string;
  unit: string;
  /** where it stands in the link */
  path: readonly string[];
  limits: Limits;
}

const place = { minimum: -1e7, maximum: 1e7 };

function option(label: string, unit: string, path: string, limits: Limits): OptionRow {
  return { key: path, label, unit, path: path.split("."), limits };
}

export type OptionGroup = readonly [title: string, rows: readonly OptionRow[]];

function ofDevice(title: string): OptionGroup {
  return [
    title,
    [
      option("Time runs at", "× real time", "time_scale", { minimum: 0, maximum: 20, fallback: 1 }),
      option("Supply", "V", "supply_v", { minimum: 0, maximum: 60, fallback: 24 }),
      option("Seed of noise and faults", "", "seed", {
        minimum: 0,
        maximum: 2 ** 32 - 1,
        integer: true,
        fallback: null,
      }),
      option("Rotor at first", "full steps", "start_fullsteps", { ...place, fallback: 0 }),
    ],
  ];
}

const MOTOR: OptionGroup = [
  "Motor and load",
  [
    option("Holding torque", "N m", "motor.holding_torque_nm", { minimum: 1e-4, maximum: 50, fallback: 0.45 }),
    option("Rated current", "A", "motor.rated_current_a", { minimum: 0.05, maximum: 20, fallback: 1.5 }),
    option("Load torque", "N m", "load.torque_nm", { minimum: -50, maximum: 50, fallback: 0 }),
    option("Load friction", "N m", "load.friction_nm", { minimum: 0, maximum: 50, fallback: 0 }),
    option("Load inertia", "kg m²", "load.inertia_kgm2", { minimum: 0, maximum: 1, fallback: 0 }),
  ],
];

const ENDS: readonly OptionRow[] = [
  option("Left", "full steps", "stage.left_at_fullsteps", { ...place, fallback: -3750 }),
  option("Right", "full steps", "stage.right_at_fullsteps", { ...place, fallback: 3750 }),
];
const HOME: readonly OptionRow[] = [
  option("Home from", "full steps", "stage.home_from_fullsteps", { ...place, fallback: -3500 }),
  option("Home to", "full steps", "stage.home_to_fullsteps", { ...place, fallback: -3400 }),
];
const STAGE = "Stage: where switches are";

function eccentricity(path: string, fallback: number): OptionRow {
  return option("Eccentricity", "°", path, { minimum: 0, maximum: 10, fallback });
}

function lines(label: string, path: string, maximum: number, fallback: number): OptionRow {
  return option(label, "", path, { minimum: 1, maximum, integer: true, fallback });
}

/**
 * What of an emulated motor and what is around it one wants to set when it is made; the rest is in the emulator panel, or
 * in REST. None for chips that only give pulses: theirs have options of their own.
 */
export function optionsOf(model: Model): readonly OptionGroup[] {
  const encoders = canModel(model, "encoder");
  const ends: OptionGroup = [STAGE, canModel(model, "home_switch") ? [...ENDS, ...HOME] : ENDS];
  if (model.tier === "names") return [["Module", ofDevice("Module")[1].filter(({ key }) => key === "time_scale")]];
  if (canModel(model, "parameters"))
    return [
      ofDevice("Module"),
      MOTOR,
      ends,
      [
        "Encoders",
        [
          eccentricity("encoders.eccentricity_deg", 0.25),
          lines("External lines", "encoders.external_lines", 2 ** 20, 1000),
        ],
      ],
    ];
  if (canModel(model, "ramp.pmul")) return [];
  // two motors of one chip are alike
  const rows = canModel(model, "closed_loop")
    ? [eccentricity("encoder.eccentricity_deg", 0), lines("Lines", "encoder.lines", 2 ** 22, 10_000)]
    : [lines("Lines", "encoder.lines", 2 ** 20, 10_000)];
  return [ofDevice("Chip"), MOTOR, ends, ...(encoders ? [["Encoder", rows] as const] : [])];
}

const rowsOf = (model: Model): OptionRow[] => optionsOf(model).flatMap(([, rows]) => [...rows]);

/** What a link says of its options, as text by key. */
export function optionsIn(link: Json, model: Model): Record<string, string> {
  return Object.fromEntries(rowsOf(model).map((row) => [row.key, said(valueAt(link, row.path))]));
}

/** The link with the options that were said; what the form does not show stays as it was. */
export function emulatorLink(
  options: Readonly<Record<string, string>>,
  model: Model,
  before: Json,
  more: Json = {},
): Json {
  return rowsOf(model).reduce<Json>(
    (link, row) => withValueAt(link, row.path, numberOf(options[row.key] ?? "")),
    over(before, "emulator", more),
  );
}

/** Every problem of the options, by the path of its field: `options.stage.left_at_fullsteps`. */
export function optionProblems(
  options: Readonly<Record<string, string>>,
  model: Model,
): [path: string, problem: string][] {
  const rows = rowsOf(model);
  if (rows.length === 0) return [];
  const found = rows.flatMap((row): [string, string][] => {
    const problem = numberProblem(options[row.key] ?? "", row.limits);
    return problem === null ? [] : [[`options.${row.key}`, problem]];
  });
  const at = (key: string) => {
    const row = rows.find((candidate) => candidate.key === `stage.${key}`);
    return parseNumber(options[`stage.${key}`] ?? "") ?? row?.limits.fallback ?? 0;
  };
  if (at("left_at_fullsteps") >= at("right_at_fullsteps"))
    found.push(["options.stage.right_at_fullsteps", "The right switch lies right of the left one"]);
  if (at("home_from_fullsteps") > at("home_to_fullsteps"))
    found.push(["options.stage.home_to_fullsteps", "The end lies right of the beginning"]);
  return found;
}

function valueAt(record: Json, path: readonly string[]): unknown {
  return path.reduce<unknown>(
    (inner, key) => (typeof inner === "object" && inner !== null ? (inner as Json)[key] : undefined),
    record,
  );
}

/** `record` with one value more, or without it; records that become empty go. */
function withValueAt(record: Json, [key = "", ...rest]: readonly string[], value: unknown): Json {
  // a rigid motor is a word, not a record: nothing said of its parts leaves it so
  if (rest.length > 0 && value === undefined && typeof record[key] !== "object") return record;
  const copy = { ...record };
  const inner = rest.length === 0 ? value : withValueAt(recordAt(copy, key), rest, value);
  const empty = inner === undefined || (rest.length > 0 && Object.keys(inner as Json).length === 0);
  if (empty) delete copy[key];
  else copy[key] = inner;
  return copy;
}

function recordAt(record: Json, key: string): Json {
  const inner = record[key];
  return typeof inner === "object" && inner !== null ? (inner as Json) : {};
}
