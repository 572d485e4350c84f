import type { Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import classes from "./currents.module.css";
import { figureLines } from "./figures";

/** What follows from motor, supply and chopper, with the reason of each as its title. */
export function Follows({ result, stale }: { result: Schemas["ChopperResult"]; stale: boolean }) {
  return (
    <Card title="What follows for this motor">
      <table className="figures fades" data-stale={stale}>
        <tbody>
          {figureLines(result.figures).map(({ name, label, values, reason, source }) => (
            <tr key={name} title={`${reason} (${source})`} data-testid={`figure-${name}`}>
              <th scope="row">{label}</th>
              <td className="num">
                {values.map((value) => (
                  <span key={value} className={classes.followsValue}>
                    {value}
                  </span>
                ))}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </Card>
  );
}
