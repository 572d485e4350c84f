import { Text } from "@mantine/core";
import { Card } from "../../lib/Card";
import { compact, fixed } from "../../lib/format";
import { StagedBar } from "../module/StagedBar";
import type { Parameters } from "../module/useParameters";
import { AP } from "./names";
import { ChoiceRow, DOWNS, FILTERS, MINIMA, NumberRow, UPS } from "./Rows";
import { lowerLoad, runCurrentA, upperLoad } from "./thresholds";

const SPEED_MAX = 7_999_774;
const COOL_OFF_MAX = 16_777_215;

interface Props {
  parameters: Parameters;
  disabled: boolean;
}

/** Every setting that the plots show, staged until applied. */
export function Thresholds({ parameters, disabled }: Props) {
  const common = { settings: parameters, disabled };
  const of = parameters.planned;
  const cool = { hysteresisStart: of(AP.coolStart), hysteresis: of(AP.coolWidth) };
  const current = { run: of(AP.runCurrent), scaler: of(AP.scaler) };
  const off = (name: string) => (of(name) === 0 ? "off" : "");
  return (
    <Card title="Thresholds" note="drag them in the plot, or type">
      <h3 className="hint bold m-0 mt-8">StallGuard</h3>
      <NumberRow
        {...common}
        name={AP.stallThreshold}
        label="Sensitivity"
        alias="AP 174"
        min={-64}
        max={63}
        note="lower stalls earlier"
      />
      <ChoiceRow {...common} name={AP.stallFilter} label="Filter" alias="AP 173" choices={FILTERS} />
      <NumberRow
        {...common}
        name={AP.stopOnStall}
        label="Stop above"
        alias="AP 181"
        unit="pps"
        min={0}
        max={SPEED_MAX}
        step={1000}
        note={off(AP.stopOnStall) || "stops at load value 0"}
      />
      <h3 className="hint bold m-0 mt-8">CoolStep</h3>
      <NumberRow
        {...common}
        name={AP.coolStart}
        label="Lower threshold"
        alias="AP 172"
        min={0}
        max={15}
        note={of(AP.coolStart) === 0 ? "CoolStep is off" : `more current below ${fixed(lowerLoad(cool))}`}
      />
      <NumberRow
        {...common}
        name={AP.coolWidth}
        label="Width"
        alias="AP 170"
        min={0}
        max={15}
        note={of(AP.coolStart) === 0 ? "" : `less current above ${fixed(upperLoad(cool))}`}
      />
      <NumberRow
        {...common}
        name={AP.coolOn}
        label="On above"
        alias="AP 182"
        unit="pps"
        min={0}
        max={SPEED_MAX}
        step={1000}
      />
      <NumberRow
        {...common}
        name={AP.coolOff}
        label="Off above"
        alias="AP 22"
        unit="pps"
        min={0}
        max={COOL_OFF_MAX}
        step={1000}
      />
      <ChoiceRow {...common} name={AP.coolMinimum} label="Least current" alias="AP 168" choices={MINIMA} />
      <ChoiceRow {...common} name={AP.coolUp} label="Up by" alias="AP 171" choices={UPS} />
      <ChoiceRow {...common} name={AP.coolDown} label="Down by 1" alias="AP 169" choices={DOWNS} />
      <h3 className="hint bold m-0 mt-8">StealthChop and current</h3>
      <NumberRow
        {...common}
        name={AP.stealthBelow}
        label="StealthChop below"
        alias="AP 186"
        unit="pps"
        min={0}
        max={SPEED_MAX}
        step={1000}
      />
      <NumberRow
        {...common}
        name={AP.stealthGradient}
        label="Gradient"
        alias="AP 187"
        min={0}
        max={255}
        note={of(AP.stealthGradient) === 0 ? "StealthChop is off" : ""}
      />
      <NumberRow
        {...common}
        name={AP.runCurrent}
        label="Run current"
        alias="AP 6"
        min={0}
        max={255}
        step={8}
        note={`${compact(runCurrentA(current), 3)} A rms`}
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
