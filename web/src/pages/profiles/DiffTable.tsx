import { Box, Switch, Text } from "@mantine/core";
import { Fragment, useMemo, useState } from "react";
import { useCatalogModel } from "../../api/queries";
import { fixed } from "../../lib/format";
import { RegisterName } from "../../lib/rows/parts";
import { chipUnit } from "../../lib/rows/physical";
import { byName, entriesOf, grouped, type Row, rowsOf, sameRows } from "./diff";
import type { Diff, Profile } from "./useProfiles";

interface Props {
  diff: Diff;
  /** what stands on the right: its other numbers are those that are the same */
  profile: Profile;
  axisNames: readonly string[];
}

/** Two sides, register by register and field by field: as the chip has it, and what it comes to. */
export function DiffTable({ diff, profile, axisNames }: Props) {
  const catalog = useCatalogModel(diff.model);
  const [onlyDifferences, setOnlyDifferences] = useState(true);
  const entries = useMemo(() => entriesOf(profile, byName(catalog.data?.rows ?? [])), [profile, catalog.data]);
  const different = useMemo(() => rowsOf(diff, entries), [diff, entries]);
  const same = useMemo(
    () =>
      onlyDifferences
        ? []
        : sameRows(different, entries, profile, catalog.data?.capabilities.includes("step_dir") === true),
    [onlyDifferences, different, entries, profile, catalog.data],
  );
  const groups = grouped([...different, ...same]);
  const count = diff.differences.length;
  return (
    <div className="grid gap-6 mt-8">
      <div className="mid lines-16 between">
        <Text size="sm" data-testid="diff-count">
          {count === 0 ? (
            <b>No difference</b>
          ) : (
            <>
              <b className="num">{fixed(count)}</b> {count === 1 ? "difference" : "differences"}
            </>
          )}
          , <span className="num">{fixed(diff.same)}</span> the same
        </Text>
        <Switch
          label="Only differences"
          checked={onlyDifferences}
          onChange={(event) => setOnlyDifferences(event.currentTarget.checked)}
        />
      </div>
      {diff.warnings.map((warning) => (
        <Text key={warning} className="caution text-12">
          {warning}
        </Text>
      ))}
      {groups.length > 0 && (
        <Box component="section" mah="60vh" className="box scroll" tabIndex={0} aria-label="Differences">
          <table className="table text-12 tight">
            <thead>
              <tr>
                <th scope="col">Register</th>
                <th scope="col">Field</th>
                <th scope="col">{diff.left}</th>
                <th scope="col">{diff.right}</th>
              </tr>
            </thead>
            <tbody>
              {groups.map(([part, rows]) => (
                <Fragment key={part}>
                  <tr data-part>
                    <th scope="colgroup" colSpan={4}>
                      {part}
                    </th>
                  </tr>
                  {rows.map((row, index) => (
                    <Line
                      key={row.key}
                      row={row}
                      again={rows[index - 1]?.name === row.name && rows[index - 1]?.axis === row.axis}
                      axisName={row.axis === null || axisNames.length < 2 ? "" : (axisNames[row.axis] ?? "")}
                    />
                  ))}
                </Fragment>
              ))}
            </tbody>
          </table>
        </Box>
      )}
    </div>
  );
}

function Line({ row, again, axisName }: { row: Row; again: boolean; axisName: string }) {
  return (
    <tr data-differs={row.differs} className={row.differs ? "" : "dim"}>
      <td>
        {again ? (
          <span className="unseen">{row.name}</span>
        ) : (
          <>
            <RegisterName name={row.name} />
            {axisName !== "" && <span className="dim"> {axisName}</span>}
          </>
        )}
      </td>
      <td>{row.field ?? ""}</td>
      <td>
        <Value value={row.before} unit={row.unit} meaning={row.beforeMeaning} />
      </td>
      <td>
        <Value value={row.after} unit={row.unit} meaning={row.afterMeaning} strong={row.differs} />
        {row.why !== "" && <span className="block caution text-12">{row.why}</span>}
        {row.differs && !row.written && row.why === "" && <span className="block caution text-12">not written</span>}
      </td>
    </tr>
  );
}

interface ValueProps {
  value: number | string | null;
  unit: string;
  meaning: string;
  strong?: boolean;
}

function Value({ value, unit, meaning, strong = false }: ValueProps) {
  return (
    <>
      <span className={`num ${strong ? "bold" : ""}`}>
        {typeof value === "number" ? (Number.isInteger(value) ? fixed(value) : String(value)) : (value ?? "?")}
      </span>
      {value !== null && chipUnit(unit) !== "" && <span className="dim"> {chipUnit(unit)}</span>}
      {meaning !== "" && <span className="hint inline-block ml-8">{meaning}</span>}
    </>
  );
}
