import { Anchor, Text } from "@mantine/core";
import { Link } from "wouter";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { placeName } from "./lines";
import css from "./program.module.css";
import type { WatchState } from "./WatchSource";

const SHOWN = 100;

/** The addresses that the program came by of late, and what happened to it, by the time of the scope. */
export function TracePanel({ watch, labels }: { watch: WatchState; labels: Readonly<Record<string, number>> }) {
  const { trace, exact, log } = watch;
  const latest = trace.slice(-SHOWN).reverse();
  return (
    <>
      <Card
        title="Trace"
        note={trace.length === 0 ? "" : exact ? "every command" : "as looked at: not every command"}
        data-testid="program-trace"
      >
        {latest.length === 0 ? (
          <Text className="hint">Addresses that the program comes by. Single steps leave out none.</Text>
        ) : (
          // biome-ignore lint/a11y/noNoninteractiveTabindex: it is scrolled with the keyboard, too
          <ol className={`${css.scrolled} list num text-13`} reversed aria-label="Latest first" tabIndex={0}>
            {latest.map((address, index) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: an address comes often, and has no name but its place
              <li key={index}>{placeName(labels, address)}</li>
            ))}
          </ol>
        )}
      </Card>
      <Card
        title="Run log"
        note={
          <>
            device time: starts, halts and ends are marks on the{" "}
            <Anchor component={Link} href="/" inherit underline="always">
              scope
            </Anchor>
            , too
          </>
        }
      >
        {log.length === 0 ? (
          <Text className="hint">Nothing has happened since this page was opened.</Text>
        ) : (
          // biome-ignore lint/a11y/noNoninteractiveTabindex: it is scrolled with the keyboard, too
          <ol className={`${css.scrolled} list text-13`} aria-label="Run log, latest first" tabIndex={0}>
            {[...log].reverse().map(({ id, timeS, text }) => (
              <li key={id} className="row gap-8">
                <span className="num dim">{fixed(timeS, 3, "s")}</span>
                <span>{text}</span>
              </li>
            ))}
          </ol>
        )}
      </Card>
    </>
  );
}
