import { Group, Select, Text } from "@mantine/core";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { ChipField } from "../../lib/rows/ChipField";
import type { ChipRows } from "../../lib/rows/useChipRows";
import { INDEX_USES, indexUse } from "./settings";

const EDGES = ["pos_edge", "neg_edge"] as const;
const LEVELS = ["pol_N", "pol_A", "pol_B"] as const;

/** What the index channel does: when it is an event, and what an event latches and clears. */
export function IndexSection({ chip, disabled }: { chip: ChipRows; disabled: boolean }) {
  const bit = (field: string) => chip.planned("ENCMODE", field);
  const use = indexUse(bit);
  const latched = (register: string) => fixed(chip.held(register));
  return (
    <Card title="Index channel" note="N">
      <Select
        label="An event makes the chip"
        data={INDEX_USES.map(({ name }) => name)}
        value={use?.name ?? null}
        placeholder={bit("clr_cont") === null ? "not known" : "do a mixture"}
        disabled={disabled}
        onChange={(name) => {
          const wanted = INDEX_USES.find((each) => each.name === name);
          for (const [field, value] of Object.entries(wanted?.fields ?? {}))
            if (bit(field) !== value) chip.put("ENCMODE", field, value);
        }}
        data-testid="index-use"
      />
      <Text size="xs" c="dimmed" my={4}>
        {use?.text ?? (bit("clr_cont") === null ? "" : "other bits of ENCMODE than these: see the registers page")}
      </Text>
      <h3 className="hint bold m-0 mt-8">An event is</h3>
      <div className="halves gap-6 mt-4">
        {EDGES.map((field) => (
          <ChipField key={field} chip={chip} register="ENCMODE" field={field} disabled={disabled} />
        ))}
        <ChipField chip={chip} register="ENCMODE" field="ignore_AB" label="at any A, B" disabled={disabled} />
        <ChipField chip={chip} register="ENCMODE" field="latch_now" disabled={disabled} />
      </div>
      <Group grow gap={6} mt={8} wrap="nowrap">
        {LEVELS.map((field) => (
          <ChipField key={field} chip={chip} register="ENCMODE" field={field} disabled={disabled} />
        ))}
      </Group>
      <dl className="facts pairs m-0 mt-8 text-12">
        <dt>ENC_LATCH</dt>
        <dd className="num" data-testid="enc-latch">
          {latched("ENC_LATCH")} µsteps
        </dd>
        {bit("latch_x_act") === 1 && (
          <>
            <dt>XLATCH</dt>
            <dd className="num">{latched("XLATCH")} µsteps</dd>
          </>
        )}
      </dl>
    </Card>
  );
}
