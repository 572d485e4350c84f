import { Text } from "@mantine/core";
import { useDevices } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { MyMotorsButton } from "../../../lib/motors/MyMotors";
import { useOwnMotors } from "../../../lib/motors/useOwnMotors";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import { measuredOf, motorOf } from "./motor";

/** A ring as it was measured and as it was fitted, and what of all that is the motor's own. */
export function Results({ study }: { study: Study }) {
  return (
    <>
      <Ring study={study} />
      <OwnMotor study={study} />
    </>
  );
}

/** What can be kept of the motor, wherever it is built in next: as a new one, or of one that is kept. */
function OwnMotor({ study }: { study: Study }) {
  const { device, axis, study: asked } = study.document;
  const axes = useDevices().data?.find(({ id }) => id === device)?.axes;
  const anyKept = useOwnMotors().data?.length;
  if (!study.identified || asked.kind !== "identification") return null;
  const draft = motorOf(
    study.identified,
    axes?.find(({ index }) => index === axis),
  );
  const measured = measuredOf(study.identified, asked.run_current_a ?? null);
  const changes = anyKept && measured.length > 0;
  if (!draft && !changes) return null;
  return (
    <Card
      title="The motor"
      actions={
        <>
          {draft && <MyMotorsButton label="Keep as my own motor" draft={draft} />}
          {changes && <MyMotorsButton label="Change one of my motors" measured={measured} />}
        </>
      }
    >
      <Text size="sm" className="dim">
        Resistance and inductance of a coil are the motor's own, as they were measured: warm, with the run current.
        Inertia is of rotor and load together, and torque that of the run current: neither is put into a new motor, the
        data sheet has them. One that is kept takes what you choose of them.
      </Text>
    </Card>
  );
}

function Ring({ study }: { study: Study }) {
  const scheme = useScheme();
  const ringing = study.identified?.ringing;
  if (!ringing) return null;
  const summary = `${compact(ringing.residual_deg, 3)}° electrical are left of all rings by the fit`;
  return (
    <Card title="A ring after a hop" note={summary}>
      <Plot
        label="Rotor after a hop, measured and fitted"
        summary={summary}
        height={220}
        series={[
          { label: "measured", unit: "°", color: colorOf("position", scheme) },
          { label: "fitted", unit: "°", color: colorOf("predicted_position", scheme) },
        ]}
        x={{ label: "time", unit: "s" }}
        scales={{ y: { label: "rotor, electrical", unit: "°" } }}
        data={[ringing.time_s, ringing.measured_deg, ringing.fitted_deg]}
      />
    </Card>
  );
}
