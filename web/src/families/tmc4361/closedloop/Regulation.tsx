import { Button, SegmentedControl, Tabs, Text } from "@mantine/core";
import { useAddressChoice } from "../../../lib/address";
import { Card } from "../../../lib/Card";
import { duration, fixed, rounded } from "../../../lib/format";
import { ChipField } from "../../../lib/rows/ChipField";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { degrees } from "./angle";

export const MODES = ["Off", "Closed loop", "PID, base 0", "PID, base VACTUAL"] as const;
const MEANINGS = [
  "The motor follows the ramp; the encoder is only watched.",
  "The field follows the rotor: it leads by as much as the deviation asks for, never more than CL_BETA.",
  "The regulator alone makes the velocity, from the deviation.",
  "The regulator adds to the velocity of the ramp.",
] as const;

/** What a loop begins to work with: a quarter turn at most, gain 1, and windows of 100 microsteps. */
const START_VALUES: readonly (readonly [register: string, field: string | undefined, value: number])[] = [
  ["CL_ANGLES", "CL_BETA", 255],
  ["CL_DELTA_P", undefined, 65_536],
  ["CL_TOLERANCE", undefined, 100],
  ["CL_TR_TOLERANCE", undefined, 100],
];

interface Props {
  chip: ChipRows;
  clockHz: number;
  disabled: boolean;
  /** a word that would not be right for closed loop, e.g. the microsteps of a full step */
  microstepsPerFullStep: number | null;
}

/** What regulates, with which gains and limits. All of it is staged. */
export function Regulation({ chip, clockHz, disabled, microstepsPerFullStep }: Props) {
  const held = chip.held("ENC_IN_CONF", "regulation_modus");
  const planned = chip.planned("ENC_IN_CONF", "regulation_modus");
  const staged = chip.isStaged("ENC_IN_CONF", "regulation_modus");
  const pid = planned === 2 || planned === 3;
  const [tab, setTab] = useAddressChoice("tab", ["", "loop", "speed", "current", "pid"]);
  const shown = tab || (pid ? "pid" : "loop");
  const angle = (value: number) => `${fixed(degrees(value), 1)}°`;
  const time = (clocks: number) => `${duration(clocks / clockHz)} a step`;
  const scale = (value: number) => fixed(((value + 1) / 256) * 100, 1, "%");
  const per256 = (value: number) => String(rounded(value / 256, 4));
  const field = (
    register: string,
    name?: string,
    more: { physical?: (value: number) => string; label?: string } = {},
  ) => (
    <ChipField
      chip={chip}
      register={register}
      disabled={disabled}
      {...(name === undefined ? {} : { field: name })}
      {...more}
    />
  );
  return (
    <Card title="Regulation" note={held === null ? "not known" : `now: ${MODES[held] ?? held}`}>
      <SegmentedControl
        fullWidth
        orientation="vertical"
        aria-label="Regulation mode"
        data={MODES.map((label, value) => ({ value: String(value), label }))}
        value={planned === null ? "" : String(planned)}
        disabled={disabled}
        onChange={(value) => chip.put("ENC_IN_CONF", "regulation_modus", Number(value))}
        data-testid="regulation"
      />
      <Text size="xs" c="dimmed" mt={4} mih={32} role="status">
        {planned === null ? "Not read yet." : MEANINGS[planned]}
        {staged && " Not applied."}
      </Text>
      {planned === 1 && microstepsPerFullStep !== null && microstepsPerFullStep !== 256 && (
        <Text size="xs" role="alert" className="fault my-4">
          Closed loop needs 256 microsteps a full step; STEP_CONF has {microstepsPerFullStep}.
        </Text>
      )}
      <Tabs value={shown} onChange={(next) => setTab(next as typeof tab)} keepMounted={false}>
        <Tabs.List grow>
          <Tabs.Tab value="loop">Loop</Tabs.Tab>
          <Tabs.Tab value="speed">Speed</Tabs.Tab>
          <Tabs.Tab value="current">Current</Tabs.Tab>
          <Tabs.Tab value="pid">PID</Tabs.Tab>
        </Tabs.List>
        <Tabs.Panel value="loop" pt={8}>
          <div className="halves start gap-8">
            {field("CL_ANGLES", "CL_BETA", { physical: angle })}
            {field("CL_DELTA_P", undefined, { physical: (value) => `gain ${rounded(value / 65_536, 4)}` })}
            {field("CL_TOLERANCE", undefined, { physical: () => "gain 1 inside" })}
            {field("CL_TR_TOLERANCE")}
            {field("CL_ANGLES", "CL_GAMMA", { physical: angle })}
            {field("CL_OFFSET")}
            {field("CL_VMIN_EMF")}
            {field("CL_VADD_EMF")}
          </div>
          <div className="grid gap-6 my-8">{field("ENC_IN_CONF", "cl_emf_en", { label: "CL_GAMMA with speed" })}</div>
          <Button
            size="compact-xs"
            variant="default"
            disabled={disabled}
            title="CL_BETA 255, gain 1, tolerances 100: after a reset gain and tolerance are 0, and the field follows nothing"
            onClick={() => {
              for (const [register, name, value] of START_VALUES) chip.put(register, name, value);
            }}
            data-testid="start-values"
          >
            Stage start values
          </Button>
        </Tabs.Panel>
        <Tabs.Panel value="speed" pt={8}>
          <div className="halves start gap-8">
            {field("CL_VMAX_CALC_P", undefined, { physical: per256 })}
            {field("CL_VMAX_CALC_I", undefined, { physical: per256 })}
            {field("PID_I_CLIP___PID_D_CLKDIV", "PID_I_CLIP")}
            {field("PID_DV_CLIP")}
            {field("ENC_VMEAN", "ENC_VMEAN_FILTER")}
            {field("ENC_VMEAN", "ENC_VMEAN_WAIT")}
            {field("ENC_VMEAN", "ENC_VMEAN_INT")}
            {field("ENC_VEL_ZERO", undefined, { physical: (clocks) => duration(clocks / clockHz) })}
          </div>
          <div className="grid gap-6 my-8">
            {field("ENC_IN_CONF", "cl_vlimit_en", { label: "limit catching up" })}
            {field("ENC_IN_CONF", "cl_velocity_mode_en", { label: "no backlog" })}
            {field("ENC_IN_CONF", "cl_clr_xact", { label: "XACTUAL from encoder" })}
          </div>
        </Tabs.Panel>
        <Tabs.Panel value="current" pt={8}>
          <div className="grid gap-6 my-8">
            {field("CURRENT_CONF", "closed_loop_scale_en", { label: "by deviation" })}
          </div>
          <div className="halves start gap-8">
            {field("SCALE_VALUES", "cl_imin", { physical: scale })}
            {field("SCALE_VALUES", "cl_imax", { physical: scale })}
            {field("SCALE_VALUES", "cl_start_up", { physical: angle })}
            {field("SCALE_VALUES", "cl_start_dn", { physical: (value) => (value === 0 ? "as CL_BETA" : angle(value)) })}
            {field("CL_UPSCALE_DELAY", undefined, { physical: time })}
            {field("CL_DNSCALE_DELAY", undefined, { physical: time })}
          </div>
          <Text size="xs" c="dimmed" mt={6}>
            With closed_loop_scale_en these bits are the loop's; without it the same bits are boost, drive and hold
            scale.
          </Text>
        </Tabs.Panel>
        <Tabs.Panel value="pid" pt={8}>
          <div className="halves start gap-8">
            {field("PID_P", undefined, { physical: per256 })}
            {field("PID_I", undefined, { physical: per256 })}
            {field("PID_D")}
            {field("PID_TOLERANCE")}
            {field("PID_I_CLIP___PID_D_CLKDIV", "PID_I_CLIP")}
            {field("PID_I_CLIP___PID_D_CLKDIV", "PID_D_CLKDIV", {
              physical: (value) => (value === 0 ? "" : `every ${duration((128 * value) / clockHz)}`),
            })}
            {field("PID_DV_CLIP")}
          </div>
          <Text size="xs" c="dimmed" mt={6}>
            PID_P, PID_I, PID_D and PID_TOLERANCE are the same words as CL_VMAX_CALC_P, CL_VMAX_CALC_I, CL_DELTA_P and
            CL_TOLERANCE: the mode says which they are.
          </Text>
        </Tabs.Panel>
      </Tabs>
    </Card>
  );
}
