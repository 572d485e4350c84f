import { Text } from "@mantine/core";
import { Card } from "../../lib/Card";
import { compact, fixed } from "../../lib/format";
import { StagedBar } from "../module/StagedBar";
import type { Parameters } from "../module/useParameters";
import { AP } from "./names";
import { ChoiceRow, DOWNS, FILTERS, MINIMA, NumberRow, UPS } from "./Rows";
import { lowerLoad, runCurrentA, upperLoad } from "./thresholds";

const SPEED = { unit: "pps", min: 0, max: 7_999_774, step: 1000 };
const COOL_OFF_MAX = 16_777_215;

interface Props {
  parameters: Parameters;
  disabled: boolean;
}

/** Every setting that the plots show, staged until applied. */
export function Thresholds({ parameters, disabled }: Props) {
  const row = (name: string, label: string, alias: string) => ({ settings: parameters, disabled, name, label, alias });
  const of = parameters.planned;
  const cool = { hysteresisStart: of(AP.coolStart), hysteresis: of(AP.coolWidth) };
  const current = { run: of(AP.runCurrent), scaler: of(AP.scaler) };
  const off = (name: string) => (of(name) === 0 ? "off" : "");
  return (
    <Card title="Thresholds" note="drag them in the plot, or type">
      <h3 className="hint bold m-0 mt-8">StallGuard</h3>
      <NumberRow {...row(AP.stallThreshold, "Sensitivity", "AP 174")} min={-64} max={63} note="lower stalls earlier" />
      <ChoiceRow {...row(AP.stallFilter, "Filter", "AP 173")} choices={FILTERS} />
      <NumberRow
        {...row(AP.stopOnStall, "Stop above", "AP 181")}
        {...SPEED}
        note={off(AP.stopOnStall) || "stops at load value 0"}
      />
      <h3 className="hint bold m-0 mt-8">CoolStep</h3>
      <NumberRow
        {...row(AP.coolStart, "Lower threshold", "AP 172")}
        min={0}
        max={15}
        note={of(AP.coolStart) === 0 ? "CoolStep is off" : `more current below ${fixed(lowerLoad(cool))}`}
      />
      <NumberRow
        {...row(AP.coolWidth, "Width", "AP 170")}
        min={0}
        max={15}
        note={of(AP.coolStart) === 0 ? "" : `less current above ${fixed(upperLoad(cool))}`}
      />
      <NumberRow {...row(AP.coolOn, "On above", "AP 182")} {...SPEED} />
      <NumberRow {...row(AP.coolOff, "Off above", "AP 22")} {...SPEED} max={COOL_OFF_MAX} />
      <ChoiceRow {...row(AP.coolMinimum, "Least current", "AP 168")} choices={MINIMA} />
      <ChoiceRow {...row(AP.coolUp, "Up by", "AP 171")} choices={UPS} />
      <ChoiceRow {...row(AP.coolDown, "Down by 1", "AP 169")} choices={DOWNS} />
      <h3 className="hint bold m-0 mt-8">StealthChop and current</h3>
      <NumberRow {...row(AP.stealthBelow, "StealthChop below", "AP 186")} {...SPEED} />
      <NumberRow
        {...row(AP.stealthGradient, "Gradient", "AP 187")}
        min={0}
        max={255}
        note={of(AP.stealthGradient) === 0 ? "StealthChop is off" : ""}
      />
      <NumberRow
        {...row(AP.runCurrent, "Run current", "AP 6")}
        min={0}
        max={255}
        step={8}
        note={`${compact(runCurrentA(current), 3, "A")} rms`}
      />
      {of(AP.unitMode) === 0 && (
        <Text size="xs" role="status" mt={4}>
          Unit mode (AP 255) is 0: speeds are in the chip's own units, and are not drawn.
        </Text>
      )}
      <StagedBar parameters={parameters} disabled={disabled} />
    </Card>
  );
}
