import { IconArrowRight } from "@tabler/icons-react";
import { type DragEvent, Fragment, type KeyboardEvent, type ReactNode, useRef } from "react";
import classes from "./Chain.module.css";
import { type Bit, byMotor, groupOf } from "./chain";

interface Props {
  label: string;
  bits: readonly Bit[];
  /** heading of a driver's box */
  heading: (motor: number, bits: readonly Bit[]) => ReactNode;
  selected: number | null;
  onSelect: (position: number) => void;
  onHover: (position: number | null) => void;
  different: ReadonlySet<number>;
  /** Shift and arrows, or dropping: take a bit to another place within its driver */
  onMove?: ((motor: number, from: number, to: number) => void) | undefined;
  onDelete?: ((motor: number, at: number) => void) | undefined;
}

const hex = (value: number) => `0x${value.toString(16).toUpperCase().padStart(2, "0")}`;

export function described(bit: Bit): string {
  const name = bit.bit_name ? `${bit.bit_name}, ` : "";
  const end = bit.next_motor ? ", next motor" : "";
  return `bit ${bit.position}, ${name}${bit.signal}${end}, RAM ${hex(bit.ram_address)} holds ${hex(bit.ram_data)}`;
}

/** A hue of ui.css a kind of signal; what is constant has none. */
const HUES: Record<string, string> = { a: "hue-blue", b: "hue-orange", motion: "hue-green", unused: "hue-violet" };

/** The chain as its bits go out: a box a driver, a cell a bit. Arrow keys walk along. */
export function ChainStrip(props: Props) {
  const { label, bits, heading, selected, onSelect, onHover, different, onMove, onDelete } = props;
  const cells = useRef(new Map<number, HTMLButtonElement>());
  const dragged = useRef<Bit | null>(null);
  const entry = bits.some((bit) => bit.position === selected) ? selected : (bits[0]?.position ?? null);

  function focus(position: number) {
    const to = Math.min(bits.length - 1, Math.max(0, position));
    onSelect(to);
    cells.current.get(to)?.focus();
  }

  function onKey(event: KeyboardEvent, bit: Bit, index: number, motor: number, size: number) {
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -6, ArrowDown: 6 }[event.key];
    if (event.shiftKey && onMove && (step === -1 || step === 1)) {
      const to = index + step;
      if (to >= 0 && to < size) {
        onMove(motor, index, to);
        focus(bit.position + step);
      }
    } else if (step !== undefined) focus(bit.position + step);
    else if (event.key === "Home") focus(0);
    else if (event.key === "End") focus(bits.length - 1);
    else if (event.key === "Delete" && onDelete) {
      onDelete(motor, index);
      focus(bit.position - (bit.position === bits.length - 1 ? 1 : 0));
    } else return;
    event.preventDefault();
  }

  return (
    // biome-ignore lint/a11y/useSemanticElements: a fieldset would bring its own frame and meaning
    <div className="flex wrap start gap-6" role="group" aria-label={label}>
      {byMotor(bits).map((motorBits, motor) => (
        <Fragment key={motorBits[0]?.position}>
          {motor > 0 && <IconArrowRight className={classes.arrow} size={18} aria-hidden />}
          <div className={`${classes.box} box shrink`}>
            <div className="row wrap gap-4 mb-4">{heading(motor, motorBits)}</div>
            <div className={classes.cells}>
              {motorBits.map((bit, index) => (
                <button
                  key={bit.position}
                  type="button"
                  ref={(node) => {
                    if (node) cells.current.set(bit.position, node);
                    else cells.current.delete(bit.position);
                  }}
                  className={`${classes.cell} grid shrink gap-2 relative ${HUES[groupOf(bit.code)] ?? ""}`}
                  data-group={groupOf(bit.code)}
                  data-nxm={bit.next_motor || undefined}
                  data-different={different.has(bit.position) || undefined}
                  aria-pressed={bit.position === selected}
                  aria-label={described(bit)}
                  tabIndex={bit.position === entry ? 0 : -1}
                  draggable={onMove !== undefined}
                  onClick={() => onSelect(bit.position)}
                  onFocus={() => onSelect(bit.position)}
                  onPointerEnter={() => onHover(bit.position)}
                  onPointerLeave={() => onHover(null)}
                  onKeyDown={(event) => onKey(event, bit, index, motor, motorBits.length)}
                  onDragStart={() => {
                    dragged.current = bit;
                  }}
                  onDragOver={(event: DragEvent) => {
                    if (dragged.current?.motor === bit.motor) event.preventDefault();
                  }}
                  onDrop={() => {
                    const from = motorBits.findIndex((other) => other.position === dragged.current?.position);
                    if (from >= 0) onMove?.(motor, from, index);
                  }}
                >
                  <span className="hint right w-full">{bit.position}</span>
                  <span className="text-12 bold tight">{bit.bit_name || "·"}</span>
                  <span className={`${classes.signal} text-12 mono tight`}>{bit.signal}</span>
                  {bit.next_motor && <span className={`${classes.nxm} text-12 bold tight`}>NxM</span>}
                </button>
              ))}
            </div>
          </div>
        </Fragment>
      ))}
    </div>
  );
}
