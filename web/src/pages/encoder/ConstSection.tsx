import { Button, Switch, Text } from "@mantine/core";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ChipField } from "../../lib/rows/ChipField";
import type { ChipRows } from "../../lib/rows/useChipRows";
import { LiveText } from "../../live/LiveText";
import { ConstFacts } from "./ConstFacts";
import { countsOf, encConst, negativeWord } from "./encConst";

const DEFAULT_COUNTS = 4000;
const FORMS = ["binary", "decimal"] as const;

interface Props {
  chip: ChipRows;
  /** whether the chip has one such register for each of two axes */
  second: boolean;
  microstepsPerTurn: number;
  /** whether samples have an encoder position: none have while nobody has set the constant */
  counted: () => boolean;
  disabled: boolean;
}

/** What a count of the encoder is worth: found from its lines, staged as the word that drifts least. */
export function ConstSection({ chip, second, microstepsPerTurn, counted, disabled }: Props) {
  const held = chip.held("ENC_CONST");
  const planned = chip.planned("ENC_CONST");
  const decimal = chip.planned("ENCMODE", "enc_sel_decimal") === 1;
  const heldDecimal = chip.held("ENCMODE", "enc_sel_decimal") === 1;
  const told = planned === null ? null : countsOf(planned, decimal, microstepsPerTurn);
  const [typed, setTyped] = useState<number | null>(null);
  const counts = typed ?? told ?? DEFAULT_COUNTS;
  const [turned, setTurned] = useState<boolean | null>(null);
  const back = turned ?? (planned !== null && planned < 0);
  const found = encConst(counts, microstepsPerTurn);
  const use = (form: (typeof FORMS)[number], way: boolean) => {
    const word = encConst(counts, microstepsPerTurn)?.[form].raw;
    if (word === undefined) return;
    chip.put("ENC_CONST", undefined, way ? negativeWord(word, form === "decimal") : word);
    chip.put("ENCMODE", "enc_sel_decimal", form === "decimal" ? 1 : 0);
  };
  const origin = chip.isStaged("ENC_CONST")
    ? "not applied"
    : chip.origin("ENC_CONST") === "written"
      ? "as last written"
      : "";
  return (
    <Card title="Resolution" note={held === null ? "not known" : origin}>
      <LiveText
        className="block caution text-12"
        read={() => (disabled || counted() ? "" : "The encoder is not told of until its resolution is set here.")}
      />
      {second && (
        <ChipField chip={chip} register="GCONF" field="enc2_enable" label="this axis' encoder" disabled={disabled} />
      )}
      <div className="halves gap-8">
        <NumberField
          label="Lines a turn"
          value={counts / 4}
          min={0.25}
          max={2 ** 26}
          step={1}
          disabled={disabled}
          onChange={(lines) => setTyped(Math.round(4 * lines))}
          data-testid="encoder-lines"
        />
        <NumberField
          label="Counts a turn"
          integer
          value={counts}
          min={1}
          max={2 ** 28}
          step={4}
          disabled={disabled}
          onChange={setTyped}
          data-testid="encoder-counts"
        />
      </div>
      <Switch
        my={8}
        label="counts the other way"
        checked={back}
        disabled={disabled}
        onChange={(event) => setTurned(event.currentTarget.checked)}
      />
      <ConstFacts
        inChip={held}
        heldDecimal={heldDecimal}
        decimal={decimal}
        counts={counts}
        microstepsPerTurn={microstepsPerTurn}
        found={found}
      />
      {found === null ? (
        <Text size="xs" role="alert" mt={6}>
          So many counts for {fixed(microstepsPerTurn)} microsteps a turn leave no constant of 15 and 16 bits.
        </Text>
      ) : (
        <div className="flex gap-6 mt-8">
          {FORMS.map((form) => (
            <Button
              key={form}
              size="compact-xs"
              variant={found.better === form || (found.better === null && form === "binary") ? "filled" : "default"}
              disabled={disabled}
              onClick={() => use(form, back)}
              data-testid={`use-${form}`}
            >
              Stage {form}
            </Button>
          ))}
        </div>
      )}
    </Card>
  );
}
