import { Button, List, Text } from "@mantine/core";
import { useState } from "react";
import { can, type Device } from "../../api/queries";
import { useAddressChoice } from "../../lib/address";
import { Card } from "../../lib/Card";
import { compact, counted, duration, fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { scaleOf } from "../../lib/units";
import { GoalCards } from "./GoalCards";
import type { FieldsProps } from "./kind";
import { documentOf, type Forms, firstForms, goalsOf, KINDS, NAMES } from "./kinds";
import { type Kind, namedOnce, type Plan } from "./study";
import classes from "./tune.module.css";
import { type Changes, usePlan } from "./useStudies";
import { VIEWS } from "./views";

interface Props {
  device: Device;
  axis: Device["axes"][number];
  changes: Changes;
  /** a study of this axis runs */
  busy: boolean;
}

/** What is wanted of the axis, and what that will do to the machine, before it does. */
export function WishCard({ device, axis, changes, busy }: Props) {
  const scale = scaleOf(axis, device.clock_hz);
  const perTurn = scale.microstepsPerFullStep === null ? null : scale.microstepsPerFullStep * scale.fullStepsPerRev;
  const [kind, setKind] = useAddressChoice("kind", NAMES);
  const sees = can(device, "encoder");
  const [forms, setForms] = useState<Forms>(() => firstForms(perTurn, sees));
  const change = <K extends Kind>(of: K, part: Partial<Forms[K]>) =>
    setForms((before) => ({ ...before, [of]: { ...before[of], ...part } }));
  const wish = documentOf(kind, forms, device.id, axis.index);
  const connected = device.state === "connected";
  // An own search begins with a setting that its user chooses: before that there is nothing to plan.
  const stated = wish.study.kind !== "custom_search" || wish.study.space.length > 0;
  const plan = usePlan(wish, connected && !busy && stated);
  const ready = connected && !busy && stated && plan.data?.missing.length === 0 && !plan.isPlaceholderData;
  return (
    <Card title="What do you want?">
      <div className="column">
        <GoalCards label="The axis shall be" goals={goalsOf(sees)} value={kind} onChange={setKind} />
        {!sees && <Text size="sm">Other goals need an encoder, and this chip reads none.</Text>}
        <Text size="sm">{KINDS[kind].text}</Text>
        <div className={classes.fields}>
          <KindFields
            kind={kind}
            forms={forms}
            change={change}
            scale={scale}
            axis={{ device: device.id, index: axis.index }}
            can={(capability) => can(device, capability)}
          />
        </div>
        {busy ? (
          <Text size="sm">A study of this axis runs. A stop, or any other command to it, ends it.</Text>
        ) : (
          <>
            {plan.data && <WhatHappens plan={plan.data} stale={plan.isPlaceholderData} />}
            {connected && <ProblemAlert error={plan.error} doing="Planning" />}
          </>
        )}
        <Button
          disabled={!ready}
          loading={changes.start.isPending}
          onClick={() => changes.start.mutate(wish)}
          data-testid="begin"
        >
          Begin (moves)
        </Button>
        <ProblemAlert error={changes.start.error} doing="Beginning" onClose={() => changes.start.reset()} />
      </div>
    </Card>
  );
}

interface KindFieldsProps<K extends Kind> extends Pick<FieldsProps<never>, "scale" | "axis" | "can"> {
  kind: K;
  forms: Forms;
  change: (of: K, part: Partial<Forms[K]>) => void;
}

/** The fields of one kind of study. */
function KindFields<K extends Kind>({ kind, forms, change, ...axis }: KindFieldsProps<K>) {
  const { Fields } = VIEWS[kind];
  return <Fields form={forms[kind]} change={(part) => change(kind, part)} {...axis} />;
}

/** The plan, in words: what moves, how far, how fast, how long; and what is missing. */
function WhatHappens({ plan, stale }: { plan: Plan; stale: boolean }) {
  return (
    <section aria-label="What it will do" data-testid="plan" className={stale ? "stale" : undefined} aria-busy={stale}>
      {plan.missing.length > 0 && (
        <>
          <Text size="sm" fw={600}>
            Missing
          </Text>
          <List size="sm" data-testid="missing">
            {plan.missing.map((line) => (
              <List.Item key={line}>{line}</List.Item>
            ))}
          </List>
        </>
      )}
      {plan.warnings.map((line) => (
        <Text key={line} size="sm" role="note">
          Mind: {line}
        </Text>
      ))}
      {plan.steps.length > 0 && (
        <List size="sm" type="ordered">
          {plan.steps.map((line) => (
            <List.Item key={line}>{line}</List.Item>
          ))}
        </List>
      )}
      {plan.position_from !== null && plan.position_to !== null && (
        <Text size="sm" mt={4}>
          Between {fixed(plan.position_from)} and {fixed(plan.position_to)} µsteps, up to{" "}
          {compact(plan.velocity_max_pps, 4, "pps")} and {compact(plan.acceleration_max_pps2)} pps²;{" "}
          {counted(plan.moves_max, "move")}, {compact(plan.way_fullsteps)} full steps and {duration(plan.time_s)} at
          most.
        </Text>
      )}
      {plan.registers.length > 0 && (
        <Text size="sm" className="dim">
          It sets, and sets back: {namedOnce(plan.registers)}.
        </Text>
      )}
      {plan.no_twin && (
        <Text size="sm" className="dim">
          Not tried on an emulated twin first: {plan.no_twin}.
        </Text>
      )}
      <Text size="sm" className="dim">
        Cut off, it {plan.goes_on ? "keeps what is whole and goes on with the rest" : "begins again"}.
      </Text>
      {plan.unwatched.map((line) => (
        <Text key={line} size="sm" className="dim">
          Not watched: {line}.
        </Text>
      ))}
    </section>
  );
}
