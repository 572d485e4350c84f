import { memo } from "react";
import type { Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import { Caution, SendPanel } from "../../../lib/ramp/SendPanel";
import type { ChipRamp, RampDifference, RampMode } from "./design";

interface Props {
  device: Device | undefined;
  axis: number;
  connected: boolean;
  chip: ChipRamp | null;
  /** null while there is no pair, so nothing complete to send */
  differences: RampDifference[] | null;
  noPair: boolean;
  mode: RampMode;
  vMax: number;
  distance: number;
}

const MODES = ["ramp", "soft", "velocity", "hold"];

export const SendSection = memo(function SendSection({ chip, noPair, mode, vMax, distance, ...panel }: Props) {
  return (
    <SendPanel
      {...panel}
      unknown={
        noPair
          ? "No pair represents p, so there is nothing complete to send."
          : "The pair is not known yet, so there is nothing complete to send."
      }
      wanted="one"
      shown={(row, value) => (/^ramp_mode$|^rm$/i.test(row.label) ? (MODES[value] ?? fixed(value)) : fixed(value))}
      cautions={(changed) =>
        notesOn(
          chip,
          mode,
          changed.some((row) => /^v_max$/i.test(row.label)),
        ).map((note) => <Caution key={note}>{note}</Caution>)
      }
      rotation={mode === "velocity" ? { velocity: distance < 0 ? -vMax : vMax, unit: "chip" } : null}
      distance={distance}
    />
  );
});

/** What a write would set going, and what it leaves. */
function notesOn(chip: ChipRamp | null, mode: RampMode, writesVMax: boolean): string[] {
  if (chip === null) return [];
  const away = (chip.target ?? 0) - (chip.position ?? 0);
  const known = chip.position !== null && chip.target !== null;
  return [
    known && away !== 0 && chip.design.v_max === 0 && chip.mode <= 1 && writesVMax
      ? `v_max is 0 on the chip and the target is ${fixed(away)} µsteps away: the motor starts as soon as v_max is written.`
      : null,
    mode === "soft" && chip.mode > 1
      ? `The chip is in ${MODES[chip.mode]} mode and is not switched at rest: a move puts it in ramp mode, after which soft mode can be sent.`
      : null,
  ].filter((note) => note !== null);
}
