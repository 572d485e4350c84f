import { memo } from "react";
import type { Device } from "../../../api/queries";
import type { ChipRamp, Dialect } from "../../../lib/ramp/chip";
import type { Mode } from "../../../lib/ramp/DesignPlots";
import type { Difference } from "../../../lib/ramp/differences";
import { Caution, SendPanel } from "../../../lib/ramp/SendPanel";
import { cautionsOn, FURTHER, shownValue } from "./chip";

interface Props {
  device: Device | undefined;
  axis: number;
  connected: boolean;
  chip: ChipRamp | null;
  /** of a module, whose parameters tell all of it */
  dialect: Dialect | null;
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
      wanted="a TMC5160, one of its family or a module with one"
      shown={shownValue}
      cautions={(changed) => cautionsOn(chip, changed).map((note) => <Caution key={note}>{note}</Caution>)}
      rotation={mode === "velocity" ? { velocity: distance < 0 ? -vmax : vmax, unit: "pps" } : null}
      distance={distance}
      proof={panel.dialect ? "read back" : "arrived"}
      foot={
        panel.dialect
          ? "Shown as registers of the driver chip in the module; what is sent goes to the parameters that set them."
          : FURTHER.some((register) => chip?.has(register))
            ? "Drawn are six points. V2, A2, D2 and TVMAX of this chip are on the Registers page; sending writes 0 to V2 and TVMAX."
            : "The chip does not tell its ramp registers: known is what was written, and a tick says that it arrived."
      }
    />
  );
});
