import type { Study } from "./study";
import classes from "./tune.module.css";

type Phase = Study["phase"];

const WORDS: readonly (readonly [Phase, string])[] = [
  ["baseline", "As it is now"],
  ["twin", "On the twin"],
  ["search", "Trials"],
  ["proof", "Proof"],
];

/** Where a study that searches is: what is over, what it does now, what comes. */
export function Phases({ study }: { study: Study }) {
  const now = WORDS.findIndex(([phase]) => phase === study.phase);
  if (now < 0) return null;
  const wanted = study.document.study;
  const twin = "twin" in wanted && wanted.twin !== null;
  return (
    <ol className={classes.phases} aria-label="Where the study is">
      {WORDS.map(([phase, word], index) =>
        phase === "twin" && !twin ? null : (
          <li
            key={phase}
            className={classes.phase}
            data-state={index < now ? "over" : index === now ? "now" : "next"}
            aria-current={index === now ? "step" : undefined}
          >
            {word}
          </li>
        ),
      )}
    </ol>
  );
}
