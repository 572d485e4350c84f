import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { duration, fixed } from "../../../lib/format";
import { ChipField } from "../../../lib/rows/ChipField";
import type { ChipRows } from "../../../lib/rows/useChipRows";

interface Props {
  chip: ChipRows;
  clockHz: number;
  disabled: boolean;
}

/** Which scale applies when, and how fast one becomes the other. All of it is staged. */
export function ScaleFields({ chip, clockHz, disabled }: Props) {
  const scale = (value: number) => fixed(((value + 1) / 256) * 100, 1, "%");
  const step = (clocks: number) => (clocks === 0 ? "at once" : `${duration(clocks / clockHz)} a step`);
  const time = (clocks: number) => duration(clocks / clockHz);
  const flag = (field: string, label: string) => (
    <ChipField chip={chip} register="CURRENT_CONF" field={field} label={label} disabled={disabled} />
  );
  const value = (field: string) => (
    <ChipField chip={chip} register="SCALE_VALUES" field={field} physical={scale} disabled={disabled} />
  );
  const word = (register: string, physical?: (value: number) => string) => (
    <ChipField chip={chip} register={register} physical={physical} disabled={disabled} />
  );
  return (
    <Card title="Current scales" note="CURRENT_CONF, SCALE_VALUES" as="div">
      <div className="grid gap-6">
        <div className="halves start gap-8">
          {value("drv1_scale_val")}
          {value("drv2_scale_val")}
          {value("boost_scale_val")}
          {value("hold_scale_val")}
        </div>
        {flag("drive_current_scale_en", "drive scale in motion")}
        {flag("sec_drive_current_scale_en", "second one above the limit")}
        {flag("boost_current_on_acc_en", "boost while the speed rises")}
        {flag("boost_current_on_dec_en", "boost while it falls")}
        {flag("boost_current_after_start_en", "boost after a start")}
        {flag("hold_current_scale_en", "hold scale at rest")}
        {flag("freewheeling_en", "no current after a while")}
        {flag("closed_loop_scale_en", "by deviation, in closed loop")}
        <div className="halves start gap-8">
          {word("VDRV_SCALE_LIMIT")}
          {word("BOOST_TIME", time)}
          {word("UP_SCALE_DELAY", step)}
          {word("DRV_SCALE_DELAY", step)}
          {word("STDBY_DELAY", time)}
          {word("HOLD_SCALE_DELAY", step)}
          {word("FREEWHEEL_DELAY", time)}
        </div>
        <Text className="hint">
          In closed loop with closed_loop_scale_en the bits of SCALE_VALUES are CL_IMIN, CL_IMAX and their angles: see
          the Closed loop page.
        </Text>
      </div>
    </Card>
  );
}
