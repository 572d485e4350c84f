import { Text } from "@mantine/core";
import { Card } from "../../lib/Card";
import { fixed, rounded } from "../../lib/format";
import type { Settings } from "../../lib/rows/settings";
import type { ChipRows } from "../../lib/rows/useChipRows";
import { placeOf } from "./chip";
import type { CurrentScale } from "./load";
import { AP } from "./names";
import { ChoiceRow, DOWNS, FILTERS, MINIMA, NumberRow, UPS } from "./Rows";
import { lowerLoad, upperLoad } from "./thresholds";

interface Props {
  chip: ChipRows;
  settings: Settings;
  current: CurrentScale;
  disabled: boolean;
}

const SPEED_MAX = 7_999_512;

/** Every setting that the plots show, in the registers of a chip. What is typed is staged. */
export function ChipThresholds({ chip, settings, current, disabled }: Props) {
  const common = { settings, disabled };
  const of = settings.planned;
  const cool = { hysteresisStart: of(AP.coolStart), hysteresis: of(AP.coolWidth) };
  const alias = (name: string) => {
    const place = placeOf(chip, name);
    return place?.field ?? place?.register ?? "";
  };
  const has = (name: string) => placeOf(chip, name) !== null;
  const row = (name: string, label: string) => ({ ...common, name, label, alias: alias(name) });
  const speed = (name: string, label: string, never: string) => {
    const place = placeOf(chip, name);
    if (place === null) return null;
    const raw = chip.planned(place.register);
    const written = chip.origin(place.register) === "written" && !settings.staged.has(name);
    return (
      <NumberRow
        {...row(name, label)}
        unit="pps"
        min={0}
        max={SPEED_MAX}
        step={1000}
        show={(value) => String(rounded(value, 5))}
        note={raw === 0 ? never : raw === null ? "" : `register ${fixed(raw)}${written ? ", as last written" : ""}`}
      />
    );
  };
  const clocks = placeOf(chip, AP.coolOn)?.counting === "tstep";
  const soft = chip.planned("SW_MODE", "en_softstop") === 1 && of(AP.stopOnStall) === 1;
  return (
    <Card title="Thresholds" note="drag them in the plot, or type">
      <h3 className="hint bold m-0 mt-8">StallGuard</h3>
      <NumberRow
        {...row(AP.stallThreshold, "Sensitivity")}
        min={-64}
        max={63}
        note={of(AP.stallThreshold) === null ? "" : "lower stalls earlier"}
      />
      <ChoiceRow {...row(AP.stallFilter, "Filter")} choices={FILTERS} />
      <ChoiceRow
        {...row(AP.stopOnStall, "A stall")}
        choices={["is told", "stops it"]}
        note={soft ? "not together with en_softstop" : ""}
      />
      {speed(AP.coolOn, "Works above", clocks ? "0: StallGuard and CoolStep never work" : "0: from standstill on")}
      <h3 className="hint bold m-0 mt-8">CoolStep</h3>
      <NumberRow
        {...row(AP.coolStart, "Lower threshold")}
        min={0}
        max={15}
        note={of(AP.coolStart) === 0 ? "CoolStep is off" : `more current below ${fixed(lowerLoad(cool))}`}
      />
      <NumberRow
        {...row(AP.coolWidth, "Width")}
        min={0}
        max={15}
        note={of(AP.coolStart) === 0 ? "" : `less current above ${fixed(upperLoad(cool))}`}
      />
      {speed(AP.coolOff, "Off above", clocks ? "0: never off" : "0: StallGuard and CoolStep never work")}
      <ChoiceRow {...row(AP.coolMinimum, "Least current")} choices={MINIMA} />
      <ChoiceRow {...row(AP.coolUp, "Up by")} choices={UPS} />
      <ChoiceRow {...row(AP.coolDown, "Down by 1")} choices={DOWNS} />
      <h3 className="hint bold m-0 mt-8">{has(AP.stealthGradient) ? "StealthChop and current" : "Current"}</h3>
      {has(AP.stealthGradient) && <ChoiceRow {...row(AP.stealthGradient, "StealthChop")} choices={["off", "on"]} />}
      {of(AP.stealthGradient) === 1 && speed(AP.stealthBelow, "StealthChop below", "0: at every speed")}
      <NumberRow
        {...row(AP.runCurrent, "Run current")}
        min={0}
        max={31}
        note={of(AP.runCurrent) === null ? "" : `${fixed(current.run, 1)} ${current.unit}`}
      />
      {has(AP.scaler) && (
        <NumberRow
          {...row(AP.scaler, "Global scaler")}
          min={0}
          max={255}
          note={of(AP.scaler) === 0 ? "0: 256/256" : `${fixed(of(AP.scaler))}/256`}
        />
      )}
      {chip.held("CHOPCONF", "toff") === 0 && (
        <Text size="xs" role="status" mt={6}>
          CHOPCONF.toff is 0: the driver is off, and the motor has no current.
        </Text>
      )}
    </Card>
  );
}
