import { Text, TextInput } from "@mantine/core";
import { useMemo, useState } from "react";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import type { RecordingDetail } from "./api";

interface Register {
  name: string;
  axis?: number | null;
  /** Null where some of its fields are what the motor was told to do, and not configuration. */
  value: number | null;
}

/** Registers of a chip, or parameters of a module. */
function registersOf(detail: RecordingDetail): Register[] {
  const { registers, parameters } = detail.configuration ?? {};
  return [registers, parameters].flatMap((each) => (Array.isArray(each) ? (each as Register[]) : []));
}

/** How the device was set when the recording began. */
export function Configuration({ detail }: { detail: RecordingDetail }) {
  const [text, setText] = useState("");
  const registers = useMemo(() => registersOf(detail), [detail]);
  const words = text.trim().toLocaleLowerCase();
  const found = registers.filter(({ name }) => name.toLocaleLowerCase().includes(words));
  return (
    <Card
      title="Configuration at the start"
      note={registers.length > 0 ? `${registers.length} registers` : undefined}
      actions={
        registers.length > 0 && (
          <TextInput
            type="search"
            aria-label="Search the configuration"
            placeholder="register"
            value={text}
            onChange={(event) => setText(event.currentTarget.value)}
          />
        )
      }
    >
      {registers.length === 0 ? (
        <Text size="xs" c="dimmed">
          It could not be read when the recording began.
        </Text>
      ) : (
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls, with the keys too
        <section className="tall scroll" tabIndex={0} aria-label="Registers at the start">
          <table className="table text-13">
            <tbody>
              {found.map(({ name, axis, value }) => (
                <tr key={`${name}/${axis}`}>
                  <th scope="row">
                    {name}
                    <span className="dim">{axis === null || axis === undefined ? "" : `.${axis}`}</span>
                  </th>
                  <td className="num right">{value === null ? "" : fixed(value)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </section>
      )}
    </Card>
  );
}
