import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { fixed, rounded } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ChipField } from "../../../lib/rows/ChipField";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { ConstFacts } from "../../../pages/encoder/ConstFacts";
import { countsOf, encConst } from "../../../pages/encoder/encConst";

const DEFAULT_LINES = 1000;

interface Props {
  chip: ChipRows;
  microstepsPerTurn: number;
  disabled: boolean;
}

/** Kind and resolution of the encoder, and what a count of it is worth: exactly, and as each of the two words. */
export function EncoderSetup({ chip, microstepsPerTurn, disabled }: Props) {
  const kind = chip.planned("GENERAL_CONF", "serial_enc_in_mode");
  const planned = chip.planned("ENC_IN_RES", "ENC_IN_RES");
  const manual = chip.planned("ENC_IN_RES", "MANUAL_ENC_CONST") === 1;
  const decimal = chip.planned("ENC_IN_CONF", "enc_sel_decimal") === 1;
  const heldDecimal = chip.held("ENC_IN_CONF", "enc_sel_decimal") === 1;
  const inChip = chip.held("ENC_CONST");
  const incremental = kind === null || kind === 0;
  const counts = planned === null || planned === 0 ? null : planned;
  // ENC_IN_RES cannot be read back, but what the chip has made of it can
  const told = inChip === null || manual ? null : countsOf(inChip, heldDecimal, microstepsPerTurn);
  const shown = counts ?? told ?? DEFAULT_LINES * 4;
  const found = manual ? null : encConst(shown, microstepsPerTurn);
  return (
    <Card title="Encoder" note={inChip === 0 ? "no resolution is set" : undefined}>
      <ChipField chip={chip} register="GENERAL_CONF" field="serial_enc_in_mode" label="kind" disabled={disabled} />
      <div className="halves start gap-8">
        <ChipField
          chip={chip}
          register="ENC_IN_RES"
          field="ENC_IN_RES"
          disabled={disabled}
          {...(incremental && !manual
            ? { physical: (value: number) => (value === 0 ? "none" : `${rounded(value / 4, 6)} lines`) }
            : {})}
        />
        {incremental ? (
          <NumberField
            label="Lines a turn"
            integer
            min={1}
            max={2 ** 28}
            value={counts === null || counts % 4 !== 0 ? null : counts / 4}
            placeholder="?"
            disabled={disabled || manual}
            description="four counts each"
            inputWrapperOrder={["label", "input", "description", "error"]}
            onChange={(lines) => chip.put("ENC_IN_RES", "ENC_IN_RES", 4 * lines)}
            data-testid="encoder-lines"
          />
        ) : (
          <span />
        )}
        <ChipField chip={chip} register="ENC_POS_DEV_TOL" disabled={disabled} />
        <ChipField chip={chip} register="ENC_IN_CONF" field="enc_sel_decimal" disabled={disabled} />
      </div>
      <div className="grid gap-6 my-8">
        <ChipField
          chip={chip}
          register="ENC_IN_CONF"
          field="invert_enc_dir"
          label="counts the other way"
          disabled={disabled}
        />
      </div>
      <ConstFacts
        inChip={inChip}
        heldDecimal={heldDecimal}
        decimal={decimal}
        counts={shown}
        microstepsPerTurn={microstepsPerTurn}
        found={found}
      />
      {manual && (
        <Text size="xs" c="dimmed">
          MANUAL_ENC_CONST: the word written is the constant itself.
        </Text>
      )}
      {!manual && counts !== null && found === null && (
        <Text size="xs" role="alert" className="fault my-4">
          So many counts for {fixed(microstepsPerTurn)} microsteps a turn leave no constant of 15 and 16 bits.
        </Text>
      )}
      {counts === null && !manual && (
        <Text size="xs" c="dimmed">
          {told === null
            ? `Set how many counts a turn has. Shown is what ${DEFAULT_LINES} lines would give.`
            : `ENC_IN_RES cannot be read back: ${fixed(told)} counts follow from the constant.`}
        </Text>
      )}
    </Card>
  );
}
