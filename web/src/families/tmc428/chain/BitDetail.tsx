import { ActionIcon, Button, Group, Select } from "@mantine/core";
import { IconArrowLeft, IconArrowRight, IconPlus, IconTrash } from "@tabler/icons-react";
import classes from "./Chain.module.css";
import { type Bit, SIGNALS } from "./chain";

interface Edit {
  first: boolean;
  last: boolean;
  full: boolean;
  only: boolean;
  onSignal: (signal: string) => void;
  onMove: (by: -1 | 1) => void;
  onInsert: () => void;
  onRemove: () => void;
}

interface Props {
  bit: Bit | null;
  /** the same place in the chip's RAM; undefined where that is not known */
  chip: Bit | null | undefined;
  /** for a custom driver: what can be done with the bit */
  edit: Edit | null;
  /** make the driver of this bit a custom one */
  onCustom: (() => void) | null;
}

const actionsOf = ({ first, last, full, only, onMove, onInsert, onRemove }: Edit) => [
  { label: "Send it earlier", title: "Earlier (Shift + ←)", Icon: IconArrowLeft, barred: first, act: () => onMove(-1) },
  { label: "Send it later", title: "Later (Shift + →)", Icon: IconArrowRight, barred: last, act: () => onMove(1) },
  { label: "Insert a bit after it", title: "Insert after", Icon: IconPlus, barred: full, act: onInsert },
  { label: "Remove the bit", title: "Remove (Delete)", Icon: IconTrash, barred: only, act: onRemove },
];

const hex = (value: number) => `$${value.toString(16).toUpperCase().padStart(2, "0")}`;
const binary = (value: number) => value.toString(2).padStart(6, "0");

/** One bit in full, with its place in the RAM, and its editor where the driver is a custom one. */
export function BitDetail({ bit, chip, edit, onCustom }: Props) {
  if (!bit)
    return (
      <div className={`${classes.detail} lines-12 mid hint between mt-8 pt-8 rule-top`}>
        Point at a bit, or walk along the chain with the arrow keys.
      </div>
    );
  return (
    <div className={`${classes.detail} lines-12 mid hint between mt-8 pt-8 rule-top`}>
      <dl className={`${classes.facts} stacked lines-12 m-0 ink`}>
        <div>
          <dt>bit</dt>
          <dd className="num">{bit.position}</dd>
        </div>
        <div>
          <dt>driver</dt>
          <dd className="num">{bit.motor + 1}</dd>
        </div>
        <div>
          <dt>its name</dt>
          <dd className="num">{bit.bit_name || "–"}</dd>
        </div>
        <div className={classes.wide}>
          <dt>signal</dt>
          <dd className="num">
            {bit.signal} {hex(bit.code)}
          </dd>
        </div>
        <div>
          <dt>RAM address</dt>
          <dd className="num">{hex(bit.ram_address)}</dd>
        </div>
        <div className={classes.wide}>
          <dt>RAM data</dt>
          <dd className="num">
            {hex(bit.ram_data)} %{binary(bit.ram_data)}
          </dd>
        </div>
        <div>
          <dt>next motor</dt>
          <dd className="num">{bit.next_motor ? "NxM" : "–"}</dd>
        </div>
        <div className={classes.wide}>
          <dt>in the chip</dt>
          <dd className={`num ${chip && chip.ram_data !== bit.ram_data ? "caution" : ""}`}>
            {chip === undefined ? "–" : chip === null ? "no bit" : `${chip.signal} ${hex(chip.ram_data)}`}
          </dd>
        </div>
      </dl>
      {edit ? (
        <Group gap={6}>
          <Select
            aria-label={`Signal of bit ${bit.position}`}
            w={124}
            data={[...SIGNALS]}
            value={bit.signal}
            placeholder={bit.signal}
            onChange={(signal) => signal && edit.onSignal(signal)}
          />
          {actionsOf(edit).map(({ label, title, Icon, barred, act }) => (
            <ActionIcon key={label} variant="default" aria-label={label} title={title} disabled={barred} onClick={act}>
              <Icon size={15} />
            </ActionIcon>
          ))}
        </Group>
      ) : (
        onCustom && (
          <Button size="compact-xs" variant="default" onClick={onCustom}>
            Edit signals as a custom driver
          </Button>
        )
      )}
    </div>
  );
}
