import { Skeleton, Text } from "@mantine/core";
import { IconTargetArrow } from "@tabler/icons-react";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Remedies } from "../../lib/Remedies";
import { Outcome } from "./Outcome";
import { figureOf, remedyOf, type Study } from "./study";
import { type Changes, useStudy } from "./useStudies";
import { VIEWS } from "./views";

interface Props {
  id: string | null;
  changes: Changes;
}

/** One study: how far it is, what was tried, what came of it, and what to do with that. */
export function StudyView({ id, changes }: Props) {
  const { data: study, error, refetch } = useStudy(id);
  if (id === null)
    return (
      <EmptyState title="Nothing tuned yet" icon={<IconTargetArrow size={22} />}>
        <Text size="sm" className="dim">
          A first look moves little, and tells what is missing before anything else is tuned.
        </Text>
      </EmptyState>
    );
  if (study === undefined)
    return error ? (
      <ProblemAlert error={error} doing="Reading the study" retry={() => void refetch()} />
    ) : (
      <Skeleton height={220} aria-label="Reading the study" />
    );
  const { Results } = VIEWS[study.document.study.kind];
  const findings = study.findings.length > 0 && <Findings study={study} />;
  const searches = Object.keys(study.units).length > 0;
  return (
    <>
      <Outcome study={study} changes={changes} />
      {!searches && findings}
      {Results && <Results study={study} changes={changes} />}
      {searches && findings}
    </>
  );
}

function Findings({ study }: { study: Study }) {
  return (
    <Card title="Found">
      <ul className="list">
        {study.findings.map((finding) => {
          const remedy = remedyOf(study.document.device, finding);
          const { figure, sure } = figureOf(finding);
          return (
            <li key={finding.name} className="row wrap gap-16" style={{ padding: "6px 0", alignItems: "start" }}>
              <div className="shrink" style={{ flex: "1 1 12rem" }}>
                <b>{finding.name}</b>
                {finding.sure !== "measured" && <span className="dim"> ({finding.sure})</span>}
                <Text size="sm" className="dim">
                  {finding.text}
                </Text>
                {remedy && <Remedies remedies={[remedy]} />}
              </div>
              <div className="right num push">
                <b>{figure}</b>
                <div className="hint">{sure}</div>
              </div>
            </li>
          );
        })}
      </ul>
    </Card>
  );
}
