import { memo } from "react";
import type { Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import type { ChipRamp } from "../../../lib/ramp/chip";
import type { Difference } from "../../../lib/ramp/differences";
import { Caution, SendPanel } from "../../../lib/ramp/SendPanel";
import { shownValue, waits } from "./chip";
import type { Options } from "./design";

interface Props {
  device: Device | undefined;
  axis: number;
  connected: boolean;
  chip: ChipRamp | null;
  /** null while the registers of the design are not known */
  differences: Difference[] | null;
  stale: boolean;
  options: Options;
  vmax: number;
  distance: number;
}

export const SendSection = memo(function SendSection({ chip, options, vmax, distance, ...panel }: Props) {
  return (
    <SendPanel
      {...panel}
      unknown="The registers are not known yet, so there is nothing to send."
      wanted="a TMC4361"
      shown={(row, value) => shownValue(row, value, fixed)}
      cautions={(changed) => notesOn(chip, changed).map((note) => <Caution key={note}>{note}</Caution>)}
      rotation={options.mode === "velocity" ? { velocity: distance < 0 ? -vmax : vmax, unit: "pps" } : null}
      distance={distance}
    />
  );
});

/** What a write would set going, or mean otherwise than it says (DS-TMC4361 8.2.2). */
function notesOn(chip: ChipRamp | null, changed: readonly Difference[]): string[] {
  if (chip === null) return [];
  const get = (name: string) => chip.get(name) ?? 0;
  const writes = (label: string) => changed.some((row) => row.label === label);
  const positioning = get("OPERATION_MODE") === 1;
  const away = get("XTARGET") - get("XACTUAL");
  const moves = get("VACTUAL") !== 0;
  return [
    positioning && away !== 0 && get("VMAX") === 0 && writes("VMAX")
      ? `VMAX is 0 on the chip and the target is ${fixed(away)} µsteps away: the motor starts as soon as VMAX is written.`
      : null,
    waits(chip) && writes("VMAX")
      ? "The chip stands in velocity mode: it is told to hold its place before VMAX is written, which would turn it."
      : null,
    !positioning && !waits(chip) && writes("VMAX")
      ? "The chip is in velocity mode: the motor turns at VMAX as soon as it is written. A move puts it in positioning mode."
      : null,
    moves && changed.some((row) => row.register === "GENERAL_CONF")
      ? "The motor moves: with other units its ramp changes until all values are written."
      : null,
    moves && positioning && changed.some((row) => row.register !== "GENERAL_CONF" && row.label !== "VMAX")
      ? "The motor moves: other ramp values than VMAX may take it beyond its target for a while."
      : null,
  ].filter((note) => note !== null);
}
