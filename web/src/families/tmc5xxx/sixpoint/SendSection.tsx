import { memo } from "react";
import type { Device } from "../../../api/queries";
import type { ChipRamp } from "../../../lib/ramp/chip";
import type { Mode } from "../../../lib/ramp/DesignPlots";
import type { Difference } from "../../../lib/ramp/differences";
import { Caution, SendPanel } from "../../../lib/ramp/SendPanel";
import { cautionsOn, FURTHER, shownValue } from "./chip";

interface Props {
  device: Device | undefined;
  axis: number;
  connected: boolean;
  chip: ChipRamp | null;
  differences: Difference[];
  mode: Mode;
  /** as the register holds it [pps] */
  vmax: number;
  distance: number;
}

export const SendSection = memo(function SendSection({ chip, mode, vmax, distance, ...panel }: Props) {
  return (
    <SendPanel
      {...panel}
      unknown=""
      wanted="a TMC5160 or one of its family"
      shown={shownValue}
      cautions={(changed) => cautionsOn(chip, changed).map((note) => <Caution key={note}>{note}</Caution>)}
      rotation={mode === "velocity" ? { velocity: distance < 0 ? -vmax : vmax, unit: "pps" } : null}
      distance={distance}
      proof="arrived"
      foot={
        FURTHER.some((register) => chip?.has(register))
          ? "Drawn are six points. V2, A2, D2 and TVMAX of this chip are on the Registers page; sending writes 0 to V2 and TVMAX."
          : "The chip does not tell its ramp registers: known is what was written, and a tick says that it arrived."
      }
    />
  );
});
