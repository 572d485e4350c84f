import { Box, Button, Group, Loader, Stack, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import type { PropsWithChildren } from "react";
import { api, type Schemas } from "../../api/client";
import { compact, fixed } from "../format";
import { ProblemAlert } from "../ProblemAlert";
import { RegisterName } from "../rows/parts";
import { useWork } from "../useWork";
import { linesOf, type Report } from "./changes";

/** What is wanted; what is left out follows from the motor, or is the family's. */
export type StartUpBody = Partial<Schemas["DeviceStartUp"]>;

async function ask(device: string, wanted: StartUpBody, dryRun: boolean): Promise<Report> {
  const body = { ...wanted, dry_run: dryRun } as never;
  // in the query too: so it needs no lease, and opening the page does not take the bench
  const query = dryRun ? { dry_run: true } : {};
  return await api.POST("/api/v1/devices/{device}/start-up", { path: { device }, query, body });
}

interface Props {
  device: string;
  body: StartUpBody;
  axisNames: readonly string[];
  disabled?: boolean;
  /** done before anything is written */
  before?: () => Promise<void>;
  onDone?: (() => void) | undefined;
  /** ends it, where there is something to close */
  close?: () => void;
}

/** What a start-up would write, register by register, then all of it at once; what came of it. */
export function StartUpPlan(props: PropsWithChildren<Props>) {
  const { device, body, axisNames, disabled = false, before, onDone, close, children } = props;
  const queries = useQueryClient();
  const dry = useQuery({
    queryKey: ["start-up", device, body],
    queryFn: () => ask(device, body, true),
    enabled: !disabled,
    retry: false,
    gcTime: 0,
    refetchOnWindowFocus: false,
  });
  const work = async () => {
    await before?.();
    return await ask(device, body, false);
  };
  const apply = useWork(work, {
    mutationKey: ["start-up", device],
    onSuccess: () => onDone?.(),
    onSettled: () => queries.invalidateQueries({ predicate: ({ queryKey }) => queryKey[0] !== "start-up" }),
  });
  if (dry.isError) return <ProblemAlert error={dry.error} doing="Planning the start-up" retry={() => dry.refetch()} />;
  if (dry.data === undefined && disabled)
    return (
      <Text size="sm" role="status">
        Connect the device: what is to be written follows from what it holds.
      </Text>
    );
  if (dry.data === undefined)
    return (
      <Group gap="xs">
        <Loader size="xs" aria-hidden />
        <Text size="sm" role="status">
          Reading what the device holds
        </Text>
      </Group>
    );
  const report = apply.data ?? dry.data;
  const lines = linesOf(report);
  return (
    <Stack gap="sm" data-testid="start-up">
      <Text size="sm" role="status" data-testid="start-up-state">
        {said(report)}
      </Text>
      {lines.length > 0 && <Changes lines={lines} axisNames={axisNames} applied={report.state !== "dry run"} />}
      {report.state === "dry run" && report.chosen.length > 0 && (
        <ul className="m-0 text-13 indent" aria-label="Chosen figures">
          {report.chosen.map((each) => (
            <li key={`${each.axis}/${each.name}`}>
              {report.axes.length > 1 && `${axisNames[each.axis] ?? `axis ${each.axis}`}: `}
              {each.name.replaceAll("_", " ").replace(/ (pps2?|a)$/, "")}{" "}
              <span className="num">
                {compact(each.value)} {each.unit}
              </span>
              : {each.why}
            </li>
          ))}
        </ul>
      )}
      {[...report.warnings, ...report.prepared].map((each) => (
        <Text key={each} size="sm">
          {each}
        </Text>
      ))}
      {apply.isError && <ProblemAlert error={apply.error} doing="Starting up" />}
      <Group gap="xs">
        {report.state === "dry run" && lines.length > 0 && (
          <Button size="sm" loading={apply.isPending} disabled={disabled} onClick={() => apply.mutate()} data-autofocus>
            Apply {fixed(report.writes.length)} {report.writes.length === 1 ? "change" : "changes"}
          </Button>
        )}
        {close && (
          <Button size="sm" variant="default" onClick={close}>
            {report.state === "dry run" && lines.length > 0 ? "Cancel" : "Close"}
          </Button>
        )}
        {children}
      </Group>
    </Stack>
  );
}

function said(report: Report): string {
  if (report.writes.length === 0) return "It is set up already: nothing to write.";
  if (report.state === "dry run")
    return "Nothing is written yet. All of it is written, each read back that can be, or everything stays as it was. No motor moves.";
  return `Done${report.took_s == null ? "" : ` in ${compact(report.took_s, 2, "s")}`}: the axis can move now.`;
}

interface ChangesProps {
  lines: ReturnType<typeof linesOf>;
  axisNames: readonly string[];
  applied: boolean;
}

function Changes({ lines, axisNames, applied }: ChangesProps) {
  return (
    <Box component="section" mah="46vh" className="box scroll" tabIndex={0} aria-label="Changes">
      <table className="table text-12 tight anywhere">
        <thead>
          <tr>
            <th scope="col">Register</th>
            <th scope="col">{applied ? "Was" : "Is"}</th>
            <th scope="col">{applied ? "Is" : "Will be"}</th>
            {applied && <th scope="col">Check</th>}
          </tr>
        </thead>
        <tbody>
          {lines.map((line) => (
            <tr key={line.key}>
              <td>
                <RegisterName name={line.name} />
                {line.axis !== null && axisNames.length > 1 && (
                  <span className="dim"> {axisNames[line.axis] ?? `axis ${line.axis}`}</span>
                )}
              </td>
              <td>
                <span className="num breaks">{line.before}</span>
                {line.beforePhysical !== "" && <span className="block dim">{line.beforePhysical}</span>}
              </td>
              <td>
                <span className="num breaks">{line.after}</span>
                {line.afterPhysical !== "" && <span className="block dim">{line.afterPhysical}</span>}
              </td>
              {applied && <td>{line.readBack}</td>}
            </tr>
          ))}
        </tbody>
      </table>
    </Box>
  );
}
