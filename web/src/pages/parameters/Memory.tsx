import { Button, Tooltip } from "@mantine/core";
import { fixed } from "../../lib/format";
import type { RegisterRow } from "../../lib/rows/bits";
import { timeOf } from "../../lib/time";
import type { EepromAction, Kept } from "./eeprom";
import css from "./parameters.module.css";
import { nameText } from "./subjects";

interface Props {
  row: RegisterRow;
  kept: Kept | undefined;
  busy: boolean;
  connected: boolean;
  onCopy: (action: EepromAction) => void;
}

/** Where a parameter lives: in RAM until power goes, in EEPROM with every write, or there when told to. */
export function Memory({ row, kept, busy, connected, onCopy }: Props) {
  if (row.stored === "auto")
    return (
      <Tooltip label="Every write goes to the EEPROM, too: it holds after power-off" openDelay={400}>
        <span className={css.memory} data-kind="eeprom">
          RAM + EEPROM
        </span>
      </Tooltip>
    );
  if (row.stored === "")
    return row.access === "R" ? null : (
      <Tooltip label="Lives in RAM: after power-off it is what it was at delivery" openDelay={400}>
        <span className={css.memory} data-kind="ram">
          RAM
        </span>
      </Tooltip>
    );
  const name = nameText(row.name);
  return (
    <span className={css.copies}>
      <Button
        size="compact-xs"
        variant="default"
        disabled={!connected || busy}
        aria-label={`Store ${name} in EEPROM`}
        onClick={() => onCopy("store")}
      >
        Store
      </Button>
      <Button
        size="compact-xs"
        variant="default"
        disabled={!connected || busy}
        aria-label={`Restore ${name} from EEPROM`}
        onClick={() => onCopy("restore")}
      >
        Restore
      </Button>
      {kept && (
        <span className={css.kept} title={`${kept.how} at ${timeOf(kept.at)}`}>
          EEPROM <span className="num">{fixed(kept.value)}</span>
        </span>
      )}
    </span>
  );
}
