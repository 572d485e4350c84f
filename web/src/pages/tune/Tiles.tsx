import classes from "./tune.module.css";

interface Props {
  label: string;
  /** what it is, and how much */
  figures: readonly (readonly [name: string, value: string])[];
}

/** The few figures that matter, large. */
export function Tiles({ label, figures }: Props) {
  return (
    <dl className={classes.tiles} aria-label={label}>
      {figures.map(([name, value]) => (
        <div key={name} className={classes.tile}>
          <dt>{name}</dt>
          <dd className="num">{value}</dd>
        </div>
      ))}
    </dl>
  );
}
