import { Button } from "@mantine/core";
import { fixed } from "../../../lib/format";
import type { RegisterRow } from "../../../lib/rows/bits";
import { timeOf } from "../../../lib/time";
import type { EepromAction, Kept } from "./eeprom";
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
      <span className="tag dim" title="Every write goes to the EEPROM, too: it holds after power-off">
        RAM + EEPROM
      </span>
    );
  if (row.stored === "unknown") return <span className="hint">unknown</span>;
  if (row.stored === "")
    return row.access === "R" ? null : (
      <span className="hint" title="Lives in RAM: after power-off it is what it was at delivery">
        RAM
      </span>
    );
  const name = nameText(row.name);
  return (
    <span className="inline wrap gap-4">
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
        <span className="hint" title={`${kept.how} at ${timeOf(kept.at)}`}>
          EEPROM <span className="num">{fixed(kept.value)}</span>
        </span>
      )}
    </span>
  );
}
