import { Button, Slider } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { frequency } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { useWork } from "../../../lib/useWork";
import classes from "./Chain.module.css";

interface Props {
  design: Schemas["ChainDesign"] | undefined;
  stale: boolean;
  clk2Div: number;
  onClk2Div: (value: number) => void;
  rampDivs: readonly number[];
  onRampDivs: (values: number[]) => void;
  /** what the chip holds; null while unknown */
  chipClk2Div: number | null;
  device: string | null;
}

/** How often the drivers can be told something (data sheet, 9.7). */
export function Frequencies(props: Props) {
  const { design, stale, clk2Div, onClk2Div, rampDivs, onRampDivs, chipClk2Div, device } = props;
  const queries = useQueryClient();
  const send = useWork(
    () =>
      api.PUT("/api/v1/devices/{device}/registers/{name}", {
        path: { device: device ?? "", name: "stepper_motor_global_parameter_register" },
        body: { fields: { clk2_div: clk2Div } },
      }),
    { onSettled: () => queries.invalidateQueries({ queryKey: ["registers", device] }) },
  );
  const cells: [name: string, value: number | null | undefined, note: string][] = [
    ["SPI clock", design?.spi_clock_hz, "fCLK / (2 · (clk2_div + 1))"],
    ["datagrams", design?.datagram_hz, "at most, back to back"],
    ["continuous update", design?.continuous_update_hz, "with continuous_update on"],
    ["full steps", design?.full_step_hz_max, "at most: one datagram each"],
  ];
  const same = chipClk2Div === clk2Div;
  return (
    <Card
      title="Frequencies"
      note={chipClk2Div === null ? "" : `the chip has clk2_div ${chipClk2Div}`}
      actions={
        <Button
          size="compact-xs"
          variant="default"
          disabled={device === null || chipClk2Div === null || same}
          loading={send.isPending}
          onClick={() => send.mutate()}
        >
          Set clk2_div in the chip
        </Button>
      }
    >
      <div className="control-line text-12">
        <span className="num">clk2_div</span>
        <Slider
          min={0}
          max={255}
          value={clk2Div}
          thumbLabel="clk2_div, the divider of the SPI clock"
          onChange={onClk2Div}
        />
        <NumberField
          aria-label="clk2_div, the divider of the SPI clock"
          value={clk2Div}
          min={0}
          max={255}
          integer
          onChange={onClk2Div}
        />
      </div>
      <p className={`my-4 ${clk2Div < 7 ? "caution" : "hint"}`}>
        {clk2Div < 7
          ? "Below 7 the clock gets no faster, only asymmetric; the chip acts as with 7."
          : "7 is the fastest, and enough for the TMC236 family."}
      </p>
      <div className="my-8 row wrap gap-8 text-12">
        <span>ramp_div of the axes</span>
        {rampDivs.map((value, index) => (
          <NumberField
            // biome-ignore lint/suspicious/noArrayIndexKey: an axis is its place
            key={index}
            aria-label={`ramp_div of axis ${index}`}
            value={value}
            min={0}
            max={13}
            integer
            w={52}
            onChange={(next) => onRampDivs(rampDivs.map((old, at) => (at === index ? next : old)))}
          />
        ))}
      </div>
      <dl className={`${classes.rates} stacked grid gap-8 m-0 mt-8 ${stale ? "stale" : ""}`} aria-busy={stale}>
        {cells.map(([name, value, note]) => (
          <div key={name}>
            <dt>{name}</dt>
            <dd className="num text-16 bold">{frequency(value)}</dd>
            <dd className="hint">{note}</dd>
          </div>
        ))}
      </dl>
      {send.isError && <ProblemAlert error={send.error} doing="Setting clk2_div" onClose={send.reset} />}
    </Card>
  );
}
