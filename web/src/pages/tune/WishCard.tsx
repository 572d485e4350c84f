import { Button, List, Switch, Text } from "@mantine/core";
import { useState } from "react";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { Choice } from "../../lib/Choice";
import { compact, duration } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { QuantityField } from "../../lib/QuantityField";
import { scaleOf } from "../../lib/units";
import { documentOf, type Form, firstForm, type Plan, WISHES } from "./study";
import { type Changes, usePlan } from "./useStudies";

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
  const [form, setForm] = useState<Form>(() => firstForm(perTurn));
  const [unit, setUnit] = useState("rev");
  const change = (part: Partial<Form>) => setForm((before) => ({ ...before, ...part }));
  const wish = documentOf(form, device.id, axis.index);
  const connected = device.state === "connected";
  const plan = usePlan(wish, connected && !busy);
  const wanted = WISHES.find(({ value }) => value === form.kind);
  const ready = connected && !busy && plan.data?.missing.length === 0 && !plan.isPlaceholderData;
  return (
    <Card title="What do you want?">
      <div className="column">
        <Choice
          label="The axis shall be"
          data={WISHES.map(({ value, label }) => ({ value, label }))}
          value={form.kind}
          onChange={(kind) => change({ kind: kind as Form["kind"] })}
          description={wanted?.text}
        />
        {form.kind === "first_look" ? (
          <>
            <NumberField
              label="Turn to either side"
              value={form.turns}
              min={0.1}
              max={20}
              unit="turns"
              onChange={(turns) => change({ turns })}
            />
            <NumberField
              label="Look for switches as far as"
              description="0: not at all"
              value={form.travelTurns}
              min={0}
              max={10_000}
              unit="turns"
              onChange={(travelTurns) => change({ travelTurns })}
            />
          </>
        ) : (
          <>
            <QuantityField
              label="Distance"
              motion="position"
              scale={scale}
              value={form.distance}
              unit={unit}
              onUnit={setUnit}
              onChange={(distance) => change({ distance })}
            />
            <NumberField
              label="Margin of speed and acceleration"
              value={form.marginPercent}
              min={0}
              max={100}
              unit="%"
              onChange={(marginPercent) => change({ marginPercent })}
            />
            <NumberField
              label="Settings tried at most"
              value={form.trials}
              min={1}
              max={1000}
              integer
              onChange={(trials) => change({ trials })}
            />
            <NumberField
              label="Never faster than"
              description="empty: the soft limit, else ten times as now"
              value={form.velocityMaxPps}
              min={1}
              unit="pps"
              onChange={(velocityMaxPps) => change({ velocityMaxPps })}
              onClear={() => change({ velocityMaxPps: null })}
            />
            <NumberField
              label="Never steeper than"
              description="empty: the same"
              value={form.accelerationMaxPps2}
              min={1}
              unit="pps^2"
              onChange={(accelerationMaxPps2) => change({ accelerationMaxPps2 })}
              onClear={() => change({ accelerationMaxPps2: null })}
            />
            <Switch
              label="Try on an emulated twin first"
              checked={form.twin}
              onChange={({ currentTarget }) => change({ twin: currentTarget.checked })}
            />
            {form.twin && (
              <>
                <NumberField
                  label="Holding torque of the motor"
                  value={form.holdingTorqueNm}
                  min={0.001}
                  max={50}
                  unit="N m"
                  onChange={(holdingTorqueNm) => change({ holdingTorqueNm })}
                />
                <NumberField
                  label="Rated current of the motor"
                  value={form.ratedCurrentA}
                  min={0.05}
                  max={20}
                  unit="A"
                  onChange={(ratedCurrentA) => change({ ratedCurrentA })}
                />
                <NumberField
                  label="Inertia of the load, at the motor"
                  value={form.loadInertiaKgm2}
                  min={0}
                  max={1}
                  unit="kg m²"
                  onChange={(loadInertiaKgm2) => change({ loadInertiaKgm2 })}
                />
              </>
            )}
            <Switch
              label="Quiet under way too"
              checked={form.quiet}
              onChange={({ currentTarget }) => change({ quiet: currentTarget.checked })}
            />
          </>
        )}
        {busy ? (
          <Text size="sm">A study of this axis runs. A stop, or any other command to it, ends it.</Text>
        ) : (
          <>
            {plan.data && <WhatHappens plan={plan.data} />}
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

/** The plan, in words: what moves, how far, how fast, how long; and what is missing. */
function WhatHappens({ plan }: { plan: Plan }) {
  return (
    <section aria-label="What it will do" data-testid="plan">
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
          Between {plan.position_from} and {plan.position_to} µsteps, up to {compact(plan.velocity_max_pps)} pps and{" "}
          {compact(plan.acceleration_max_pps2)} pps²; {plan.moves_max} moves, {compact(plan.way_fullsteps)} full steps
          and {duration(plan.time_s)} at most.
        </Text>
      )}
      {plan.registers.length > 0 && (
        <Text size="sm" className="dim">
          It sets, and sets back: {plan.registers.join(", ")}.
        </Text>
      )}
      {plan.unwatched.map((line) => (
        <Text key={line} size="sm" className="dim">
          Not watched: {line}.
        </Text>
      ))}
    </section>
  );
}
