/** One figure of a wave. */
export interface FigureRow<Figures> {
  name: string;
  title: string;
  of: (figures: Figures) => string;
  /** what to compare, the smaller the less; null where it is no figure of merit */
  worth: ((figures: Figures) => number | null) | null;
}

interface Props<Figures> {
  rows: readonly FigureRow<Figures>[];
  before: Figures | null;
  beforeName: string;
  after: Figures;
  /** what to call a worth that has become less, or more */
  words: readonly [less: string, more: string];
  /** less is better, and looks so */
  judged: boolean;
}

/** The figures of the design beside those of the wave in the chip, or of the power-on wave. */
export function FiguresTable<Figures>({ rows, before, beforeName, after, words, judged }: Props<Figures>) {
  return (
    <table className="figures">
      <thead>
        <tr>
          <th scope="col">figure</th>
          <th scope="col">{beforeName}</th>
          <th scope="col">design</th>
          <td />
        </tr>
      </thead>
      <tbody>
        {rows.map((row) => {
          const more = change(row, before, after);
          return (
            <tr key={row.name}>
              <th scope="row" title={row.title}>
                {row.name}
              </th>
              <td className="num">{before ? row.of(before) : "–"}</td>
              <td className="num">{row.of(after)}</td>
              <td className={judged ? (more > 0 ? "caution text-12" : "good text-12") : "dim"}>
                {more === 0 ? "" : words[more < 0 ? 0 : 1]}
              </td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

/** -1 where the figure has become less, 1 where more. */
function change<Figures>(row: FigureRow<Figures>, before: Figures | null, after: Figures): -1 | 0 | 1 {
  if (!before || !row.worth) return 0;
  const [old, now] = [row.worth(before), row.worth(after)];
  if (old === null || now === null || Math.abs(old - now) < 1e-9) return 0;
  return now < old ? -1 : 1;
}
