import { compact, duration, fixed } from "../../lib/format";
import { useScheme } from "../../lib/useScheme";
import type { Figures } from "./api";
import { type Channel, colorOfQuantity, labelOf, severalAxes, unitText } from "./channels";

interface Side {
  id: string;
  name: string;
  figures: Readonly<Record<string, Figures>>;
}

interface Props {
  channels: readonly Channel[];
  sides: readonly Side[];
  stale?: boolean;
}

const COLUMNS: readonly { label: string; means?: string; of: (figures: Figures) => string }[] = [
  { label: "Peak", means: "the value farthest from 0", of: ({ peak }) => compact(peak, 5) },
  { label: "Lowest", of: ({ minimum }) => compact(minimum, 5) },
  { label: "Highest", of: ({ maximum }) => compact(maximum, 5) },
  { label: "Mean", of: ({ mean }) => compact(mean, 5) },
  { label: "RMS", means: "root of the mean square", of: ({ rms }) => compact(rms, 5) },
  {
    label: "Overshoot",
    means: "beyond the last value, of what ends elsewhere than it began",
    of: ({ overshoot }) => compact(overshoot, 4),
  },
  {
    label: "Settling",
    means: "until it stays within 2 % of the way of its last value",
    of: ({ settling_s }) => duration(settling_s),
  },
  { label: "Missing", means: "samples that should be there", of: ({ missing }) => fixed(missing) },
];

const MEANINGS = COLUMNS.flatMap(({ label, means }) => (means === undefined ? [] : [`${label}: ${means}.`])).join(" ");

/** Figures of each channel; of several recordings under each other. */
export function FiguresTable({ channels, sides, stale = false }: Props) {
  const scheme = useScheme();
  const several = severalAxes(channels);
  const known = new Map(channels.map((channel) => [channel.name, channel]));
  const names = [...new Set(sides.flatMap(({ figures }) => Object.keys(figures)))];
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: on a phone it scrolls sideways, with the keys too
    <section className="scroll-x" tabIndex={0} aria-label="Figures by channel">
      <table className={`table text-13 nowrap ${stale ? "stale" : ""}`} data-testid="figures">
        <thead>
          <tr>
            <th>Channel</th>
            {sides.length > 1 && <th>Recording</th>}
            {COLUMNS.map(({ label }) => (
              <th key={label} className="right">
                {label}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {names.flatMap((name) => {
            const channel = known.get(name) ?? derived(name, known);
            const having = sides.filter(({ figures }) => figures[name] !== undefined);
            return having.map((side, index) => (
              <tr key={`${name}/${side.id}`}>
                {index === 0 && (
                  <th scope="row" rowSpan={having.length}>
                    <span
                      className="swatch swatch-before"
                      style={{ background: colorOfQuantity(channel.quantity, scheme) }}
                      aria-hidden
                    />
                    {labelOf(channel, several)} <span className="dim">{unitText(channel.unit)}</span>
                  </th>
                )}
                {sides.length > 1 && <td className="dim">{side.name}</td>}
                {COLUMNS.map(({ label, of }) => (
                  <td key={label} className="num right">
                    {of(side.figures[name] as Figures)}
                  </td>
                ))}
              </tr>
            ));
          })}
        </tbody>
      </table>
      <p className="hint m-0 mt-4">{MEANINGS}</p>
    </section>
  );
}

/** What the server has worked out of two channels: in the unit of the axis's position. */
function derived(name: string, known: ReadonlyMap<string, Channel>): Channel {
  const at = name.lastIndexOf(".");
  const axis = Number(name.slice(at + 1));
  return { name, quantity: name.slice(0, at), axis, unit: known.get(`position.${axis}`)?.unit ?? "" };
}
