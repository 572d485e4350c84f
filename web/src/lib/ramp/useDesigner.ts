import { useCallback, useEffect, useMemo } from "react";
import { can, type Device, useCatalogModel } from "../../api/queries";
import { scaleOf } from "../units";
import { useSessionKept } from "../useKept";
import type { Kind } from "./answer";
import { type ChipRamp, chipRamp, dialectOf } from "./chip";
import { MOTOR, type Motor } from "./motor";
import { unitsOf } from "./scales";
import { useAxisRegisters } from "./useAxisRegisters";
import { useLive } from "./useLive";
import { useSketch } from "./useSketch";

/** What is designed, which of its values go together, and whatever else a kind of ramp is made of. */
export interface Sketch<Design, Lock, More> {
  design: Design;
  lock: Lock;
  distance: number;
  more: More;
}

/** A kind of ramp: what a designer of it begins with, and how it changes. */
export interface RampRules<Design, Lock, More> {
  /** of what is kept for the session */
  name: string;
  /** the registers that it is compared with */
  groups: readonly string[];
  /** what it is drawn as */
  kinds: readonly Kind[];
  fresh: Sketch<Design, Lock, More>;
  changed: (design: Design, parameter: keyof Design, value: number, lock: Lock) => Design;
  locked: (design: Design, lock: Lock) => Design;
  lockOf: (design: Design) => Lock;
  showingDistance: (design: Design) => number;
  /** what the chip holds; null where that is not known, or has never been set */
  read: (chip: ChipRamp, clockHz: number, more: More) => { design: Design; more: More } | null;
}

/** A designer works without a chip, too: then at this clock, and with a driver of 256 microsteps. */
const CLOCK_HZ = 16e6;
const MICROSTEPS = 256;

/** A sketch of a ramp for an axis, kept for the session: how it is changed, in which units it is read, and the chip beside it. */
export function useDesigner<Design, Lock, More>(
  rules: RampRules<Design, Lock, More>,
  device: Device | undefined,
  axis: number,
) {
  const clockHz = device?.clock_hz ?? CLOCK_HZ;
  const info = device?.axes[axis];
  const { connected, readings } = useAxisRegisters(device, axis, rules.groups);
  const module = can(device, "parameters");
  const rows = useCatalogModel(module ? device?.model : undefined).data?.rows;
  const microsteps = info?.microsteps_per_full_step ?? MICROSTEPS;
  const { told, dialect } = useMemo(() => {
    if (!readings.data || (module && !rows)) return { told: null, dialect: null };
    const dialect = module && rows ? dialectOf(rows, readings.data, { clockHz, microsteps }) : null;
    return { told: dialect?.chip ?? chipRamp(readings.data), dialect };
  }, [readings.data, module, rows, clockHz, microsteps]);
  const chip = connected ? told : null;
  const own = `${device?.id ?? "-"}.${axis}`;
  const { sketch, latest, change, isFresh } = useSketch(`stepscope.${rules.name}.sketch.${own}`, rules.fresh);
  const [unitKey, setUnits] = useSessionKept(`stepscope.${rules.name}.units`, "pps");
  const [motor, setMotor] = useSessionKept<Motor>(`stepscope.${rules.name}.motor.${own}`, MOTOR);
  const onMotor = useCallback((part: Partial<Motor>) => setMotor((before) => ({ ...before, ...part })), [setMotor]);
  const whose = info?.name ?? "a ramp";
  const onChange = useCallback(
    (parameter: keyof Design, value: number) =>
      change(
        { design: rules.changed(latest.current.design, parameter, value, latest.current.lock) },
        `Design ${whose}: ${String(parameter)}`,
      ),
    [rules, change, latest, whose],
  );
  const onLock = useCallback(
    (lock: Lock) =>
      change({ lock, design: rules.locked(latest.current.design, lock) }, `Design ${whose}: what goes together`),
    [rules, change, latest, whose],
  );
  const onMore = useCallback(
    (part: Partial<More>) =>
      change({ more: { ...latest.current.more, ...part } }, `Design ${whose}: ${Object.keys(part).join(", ")}`),
    [change, latest, whose],
  );
  const onDistance = useCallback(
    (distance: number) => change({ distance }, `Design ${whose}: distance`),
    [change, whose],
  );
  /** Begin anew with this design, at a distance that shows it; `label` as of a change. */
  const take = useCallback(
    (design: Design, more: More, label: string | null = `Design ${whose} anew`) =>
      change(
        {
          design,
          more,
          lock: rules.lockOf(design),
          distance: Math.sign(latest.current.distance || 1) * rules.showingDistance(design),
        },
        label,
      ),
    [rules, change, latest, whose],
  );

  const held = useMemo(
    () => (chip ? rules.read(chip, clockHz, sketch.more) : null),
    [rules, chip, clockHz, sketch.more],
  );
  const read = useCallback(
    () => held && take(held.design, held.more, `Design ${whose}: as the chip has it`),
    [held, take, whose],
  );
  // The first look at a chip is its own setting, unless it is not known or has never been set.
  // biome-ignore lint/correctness/useExhaustiveDependencies: once, when the chip is known and nothing was kept
  useEffect(() => {
    if (isFresh && held) take(held.design, held.more, null);
  }, [held === null]);

  const scale = useMemo(
    () => ({ ...scaleOf(info, clockHz), ...(device ? {} : { microstepsPerFullStep: MICROSTEPS }) }),
    [info, clockHz, device],
  );
  const units = useMemo(() => unitsOf(unitKey, scale), [unitKey, scale]);
  const way: 1 | -1 = sketch.distance < 0 ? -1 : 1;
  return {
    ...{ device, axis, connected, readings, chip, dialect, clockHz, scale, units, setUnits, motor, onMotor, way },
    ...{ kinds: rules.kinds, sketch, latest, change, take, onChange, onLock, onMore, onDistance },
    onRead: held === null ? null : read,
    live: useLive(rules.kinds),
  };
}

/** What the parts of a page ask of it that are the same for every kind of ramp. */
export type AnyDesigner = Omit<
  ReturnType<typeof useDesigner<object, string, object>>,
  "sketch" | "latest" | "change" | "take" | "onChange" | "onLock" | "onMore"
> & { sketch: { distance: number } };
