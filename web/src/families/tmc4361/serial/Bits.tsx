import classes from "./serial.module.css";

interface Props {
  label: string;
  names: readonly string[];
  bits: readonly number[];
}

const WHAT: Record<string, string> = { T: "turns", A: "angle", S: "status" };

/** The bits of an answer in the order in which they are sent. */
export function Bits({ label, names, bits }: Props) {
  return (
    <ol className={`${classes.bits} bare`} aria-label={label}>
      {names.map((name, place) => (
        <li key={name} data-part={name[0]} title={`${name}: bit ${name.slice(1)} of the ${WHAT[name[0] ?? ""]}`}>
          <span className="mono text-12">{name}</span>
          <span className="num bold">{bits[place]}</span>
        </li>
      ))}
    </ol>
  );
}
