import { Table, Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import { Parallel } from "../trials/Parallel";
import { useStateColors } from "../trials/useStateColors";
import {
  type CoolSetting,
  type CoolStepFound,
  coolPointsOf,
  FIELDS,
  isSame,
  type LeastCurrentFound,
  triedOf,
} from "./tried";

/** What held at which current, and what it saves. */
export function Results({ study }: { study: Study }) {
  const found = study.least_current;
  if (!found || found.tried.length === 0) {
    return null;
  }
  return (
    <>
      <Found found={found} />
      {found.coolstep && (found.coolstep.why || found.coolstep.tried.length > 0) && <CoolStep cool={found.coolstep} />}
    </>
  );
}

const settingOf = (setting: CoolSetting) =>
  FIELDS.map((field) => `${field.toUpperCase()} ${setting[field]}`).join(", ");

/** What CoolStep takes away where the load is small, or why there is none. */
function CoolStep({ cool }: { cool: CoolStepFound }) {
  const { setting, interval_share: around, saved_share: saved, saving } = cool;
  const shown = setting !== null && saved !== null && around !== null;
  return (
    <Card title="CoolStep" note={shown ? `${compact(100 * saved, 3, "%")} less heat` : cool.why ? "none" : undefined}>
      {cool.why && <Text size="sm">There is none: {cool.why}.</Text>}
      {shown && (
        <Text size="sm">
          {settingOf(setting)}: {compact(100 * saved, 3, "%")} less heat of the coils while it moves (
          {compact(100 * around.low, 3)} to {compact(100 * around.high, 3, "%")}, {cool.pairs.length} pairs of load
          cycles){saving && `, about ${compact(saving.saved_w, 3, "W")}`}.
        </Text>
      )}
      <Parallel trials={coolPointsOf(cool)} label="All settings of CoolStep that were tried" />
      {cool.tried.length > 0 && (
        <Table.ScrollContainer minWidth={420} type="native">
          <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label="Settings of CoolStep that were tried">
            <Table.Thead>
              <Table.Tr>
                {FIELDS.map((field) => (
                  <Table.Th scope="col" key={field}>
                    {field.toUpperCase()}
                  </Table.Th>
                ))}
                <Table.Th scope="col">Up to</Table.Th>
                <Table.Th scope="col">Cycles</Table.Th>
                <Table.Th scope="col">Heat left</Table.Th>
                <Table.Th scope="col" />
              </Table.Tr>
            </Table.Thead>
            <Table.Tbody>
              {cool.tried.map((one, index) => (
                // biome-ignore lint/suspicious/noArrayIndexKey: a setting may be tried again, and the list only grows
                <Table.Tr key={index} fw={setting && isSame(one.setting, setting) ? 700 : undefined}>
                  {FIELDS.map((field) => (
                    <Table.Td className="num" key={field}>
                      {one.setting[field]}
                    </Table.Td>
                  ))}
                  <Table.Td className="num">{one.scale + 1}/32</Table.Td>
                  <Table.Td className="num">{one.cycles}</Table.Td>
                  <Table.Td className="num">
                    {one.heat_share === null ? "" : compact(100 * one.heat_share, 3, "%")}
                  </Table.Td>
                  <Table.Td>{one.held ? "held" : "steps lost"}</Table.Td>
                </Table.Tr>
              ))}
            </Table.Tbody>
          </Table>
        </Table.ScrollContainer>
      )}
    </Card>
  );
}

function Found({ found }: { found: LeastCurrentFound }) {
  const { held, lost } = useStateColors();
  const { saving } = found;
  const cooler = found.heat_share === null ? undefined : `${compact(100 * (1 - found.heat_share), 3, "%")} less heat`;
  const note = found.limited_by_supply ? "limited by the supply voltage" : cooler;
  return (
    <Card title="Current" note={note}>
      <Plot
        label="Peak deviation over the run current"
        height={190}
        series={[
          { label: "no step was lost", color: held, dots: 7 },
          { label: "steps were lost", color: lost, dots: 7 },
        ]}
        x={{ label: "run current", unit: "1/32" }}
        scales={{ y: { label: "peak deviation", unit: "full steps", include: [0] } }}
        data={triedOf(found)}
      />
      <Table.ScrollContainer minWidth={320} type="native">
        <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label="Currents that were tried">
          <Table.Thead>
            <Table.Tr>
              <Table.Th scope="col">Run current</Table.Th>
              <Table.Th scope="col">Of before</Table.Th>
              <Table.Th scope="col">Speed</Table.Th>
              <Table.Th scope="col">Cycles</Table.Th>
              <Table.Th scope="col" />
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {found.tried.map((one, index) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: a scale may be tried again, and the list only grows
              <Table.Tr key={index}>
                <Table.Th scope="row">{one.scale + 1}/32</Table.Th>
                <Table.Td className="num">{compact(100 * one.share, 3, "%")}</Table.Td>
                <Table.Td className="num">{compact(100 * one.speed_times, 3, "%")}</Table.Td>
                <Table.Td className="num">{one.cycles}</Table.Td>
                <Table.Td>{one.held ? "held" : "steps lost"}</Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
      {saving && (
        <Text size="sm">
          Heat of the coils while it moves, calculated: {compact(saving.before_w, 3, "W")} before,{" "}
          {compact(saving.after_w, 3, "W")} after; {compact(saving.saved_w, 3, "W")} less (
          {compact(saving.interval_w.low, 3)} to {compact(saving.interval_w.high, 3, "W")} with the winding at 20 to 80
          °C).
        </Text>
      )}
    </Card>
  );
}
