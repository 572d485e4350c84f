import { Text } from "@mantine/core";
import { LiveText } from "../../live/LiveText";
import classes from "./module.module.css";

interface Props {
  label: string;
  unit: string;
  read: () => string;
  /** the colour of its trace in the plots */
  color?: string;
  testId?: string;
}

/** One live value with its name and unit, in a place that does not change with its digits. */
export function LiveNumber({ label, unit, read, color, testId }: Props) {
  return (
    <div className={classes.number}>
      <Text size="xs" c="dimmed" className="row gap-4 tight nowrap">
        {color && <span className="swatch" style={{ background: color }} />}
        {label}
      </Text>
      <div className="flex baseline gap-4">
        <LiveText className={`${classes.numberValue} figure-20 right nowrap`} read={read} data-testid={testId} />
        <span className="hint nowrap">{unit}</span>
      </div>
    </div>
  );
}
