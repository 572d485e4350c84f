import { Alert, Button, Checkbox, Group, Progress, Text } from "@mantine/core";
import { IconArrowBackUp, IconCheck, IconMinus, IconX } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { useState } from "react";
import { problemOf, type Schemas } from "../../api/client";
import { type Device, useCatalogModel } from "../../api/queries";
import { compact, fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import css from "./profiles.module.css";
import { type Fate, fatesOf, type StepLine, WRITTEN_BLIND, writtenLines } from "./steps";
import { type Applied, type Profile, useApply, useApplyState, useUnfinished } from "./useProfiles";

interface Props {
  profile: Profile;
  device: Device;
  dry: Applied;
  /** `dry` is from before: the last comparison has failed */
  outdated: boolean;
}

const PHASES: Readonly<Record<NonNullable<Schemas["ApplyProgress"]["phase"]>, string>> = {
  comparing: "Reading what the device holds",
  writing: "Writing, each read back that can be",
  checking: "Reading everything once more",
  "way back": "A step failed: going back",
  over: "Done",
};

/** The profile into the device, as one transaction: what it would write, how far it is, and what came of it. */
export function Apply({ profile, device, dry, outdated }: Props) {
  const apply = useApply(device.id);
  const state = useApplyState(device.id, apply.isPending);
  const [limits, setLimits] = useState(false);
  const writes = dry.differences.filter(({ kind, written }) => written || (kind === "limits" && limits)).length;
  const hasLimits = dry.differences.some(({ kind }) => kind === "limits");
  const unfinished = state.data?.state === "unfinished" ? state.data.unfinished : null;
  const running = apply.isPending || state.data?.state === "running";
  return (
    <div data-testid="apply">
      {unfinished && <Unfinished device={device} left={unfinished} />}
      <div className="mid lines-16">
        <Button
          disabled={writes === 0 || outdated || unfinished !== null || device.state !== "connected"}
          loading={running}
          onClick={() => apply.mutate({ profile, limits })}
        >
          {writes === 0 ? "Nothing to apply" : `Apply ${fixed(writes)} ${writes === 1 ? "change" : "changes"}`}
        </Button>
        {hasLimits && (
          <Checkbox
            label="Its soft limits too"
            checked={limits}
            onChange={(event) => setLimits(event.currentTarget.checked)}
          />
        )}
        {writes > 0 && !running && (
          <Text className="hint">
            All of it or nothing: every write is read back where the chip allows it, and the first that fails takes the
            others back. The motor has to stand.
          </Text>
        )}
      </div>
      {running && state.data?.phase && (
        <div role="status" aria-live="polite">
          <Text size="sm" mt={8}>
            {PHASES[state.data.phase]}
            {state.data.total > 0 && (
              <>
                {": "}
                <span className="num">
                  {fixed(state.data.done)} of {fixed(state.data.total)}
                </span>{" "}
                {state.data.register_name}
              </>
            )}
          </Text>
          <Progress
            mt={4}
            size="sm"
            aria-label="Applied so far"
            value={state.data.total > 0 ? (100 * state.data.done) / state.data.total : 0}
          />
        </div>
      )}
      {apply.isSuccess && <Done applied={apply.data} device={device.name} onClose={() => apply.reset()} />}
      {apply.isError && <Failed error={apply.error} dry={dry} onClose={() => apply.reset()} />}
    </div>
  );
}

function Done({ applied, device, onClose }: { applied: Applied; device: string; onClose: () => void }) {
  const catalog = useCatalogModel(applied.model);
  const lines = writtenLines(applied, catalog.data?.rows ?? null);
  const blind = lines.filter(({ fate }) => fate === WRITTEN_BLIND).length;
  return (
    <Alert
      mt={8}
      p="sm"
      color="gray"
      role="status"
      icon={<IconCheck size={18} aria-hidden />}
      title={`The profile is in ${device}`}
      withCloseButton
      closeButtonLabel="Dismiss"
      onClose={onClose}
    >
      <Text size="sm">
        <span className="num">{fixed(applied.written.length)}</span> registers written
        {blind === 0 ? ", each read back" : `, ${fixed(blind)} of them cannot be read back`}
        {applied.settings.length > 0 && `, ${fixed(applied.settings.length)} settings of the connection changed`}
        {applied.took_s != null && (
          <>
            {" "}
            in <span className="num">{compact(applied.took_s, 2)}</span> s
          </>
        )}
        .
      </Text>
      {applied.prepared.map((each) => (
        <Text key={each} size="sm">
          {each}
        </Text>
      ))}
      <Steps lines={lines} />
    </Alert>
  );
}

function Failed({ error, dry, onClose }: { error: unknown; dry: Applied; onClose: () => void }) {
  const problem = problemOf(error);
  const lines = fatesOf(problem, dry);
  return (
    <div>
      <ProblemAlert error={error} doing="Applying the profile" onClose={onClose} />
      {lines.length > 0 && <Steps lines={lines} />}
    </div>
  );
}

/** What was begun and never ended: by a crash of the server, or because the way back failed. */
function Unfinished({ device, left }: { device: Device; left: Schemas["UnfinishedProfile"] }) {
  const { takeBack, forget } = useUnfinished(device.id);
  return (
    <Alert
      mb={8}
      p="sm"
      color="red"
      role="alert"
      icon={<IconArrowBackUp size={18} aria-hidden />}
      title={`"${left.profile}" is half in ${device.name}`}
    >
      <Text size="sm">
        {left.crashed ? "The server ended while it was being applied." : "A step failed, and not everything went back."}{" "}
        Take it back, or leave the device as it is.
      </Text>
      <Group gap="xs" mt="xs">
        <Button size="compact-sm" loading={takeBack.isPending} onClick={() => takeBack.mutate()}>
          Take it back
        </Button>
        <Button size="compact-sm" variant="default" loading={forget.isPending} onClick={() => forget.mutate()}>
          Leave it so
        </Button>
      </Group>
      {takeBack.isError && <ProblemAlert error={takeBack.error} doing="Going back" />}
      {forget.isError && <ProblemAlert error={forget.error} doing="Forgetting it" />}
      <Steps
        lines={left.registers.map((half) => ({
          ...half,
          fate: half.state === "left" ? "left" : half.state === "not begun" ? "not begun" : "written",
        }))}
      />
    </Alert>
  );
}

const ICONS: Readonly<Record<Fate, ReactNode>> = {
  "read back": <IconCheck size={13} aria-hidden />,
  written: <IconCheck size={13} aria-hidden />,
  [WRITTEN_BLIND]: <IconCheck size={13} aria-hidden />,
  failed: <IconX size={13} aria-hidden />,
  "gone back": <IconArrowBackUp size={13} aria-hidden />,
  left: <IconX size={13} aria-hidden />,
  "not begun": <IconMinus size={13} aria-hidden />,
};

const FATE_LOOKS: Record<string, string> = { "read back": "good", left: "fault", failed: "fault" };

/** Each write and how it fared. */
function Steps({ lines }: { lines: readonly StepLine[] }) {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: what can be scrolled must be reached by keyboard
    <ol className={`${css.steps} list grid gap-2 mt-8 text-12 scroll`} tabIndex={0} aria-label="Steps">
      {lines.map((line, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: the same register may be written twice
        <li key={index}>
          <span className={`inline gap-4 ${FATE_LOOKS[line.fate] ?? ""}`}>
            {ICONS[line.fate]}
            {line.fate}
          </span>
          <span>
            {line.name}
            {line.axis !== null && <span className="dim"> axis {line.axis}</span>}
            {line.why && <span className="block caution text-12">{line.why}</span>}
          </span>
          <span className="num">
            {line.was === null ? "?" : fixed(line.was)} → {line.now === null ? "?" : fixed(line.now)}
          </span>
        </li>
      ))}
    </ol>
  );
}
