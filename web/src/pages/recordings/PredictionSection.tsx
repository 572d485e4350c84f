import { Button, Group, Select, Text } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../api/client";
import { putIntoAddress, useAddress } from "../../lib/address";
import { Card } from "../../lib/Card";
import { Loading } from "../../lib/Loading";
import { ProblemAlert } from "../../lib/ProblemAlert";
import type { RecordingDetail } from "./api";
import { ComparePlots, Differences } from "./CompareView";
import type { Window } from "./ZoomData";

const AS_RECORDED = "as it was set then";
const MOVES = ["position", "velocity", "encoder_position"];

interface Props {
  detail: RecordingDetail;
  window: Window | null;
  onWindow: (window: Window | null) => void;
}

/** What the calculators expect of the commands in a recording, beside what was measured. The address keeps what of. */
export function PredictionSection({ detail, window, onWindow }: Props) {
  const { predict, by } = useAddress("predict", "by");
  const axes = [...new Set(detail.channels.filter(({ quantity }) => MOVES.includes(quantity)).map(({ axis }) => axis))];
  const on = axes.some((axis) => String(axis) === predict);
  const [settled] = useDebouncedValue(window, 120);
  const query = useQuery({
    queryKey: ["prediction", detail.id, predict, by, settled],
    queryFn: () =>
      api.GET("/api/v1/recordings/{recording}/prediction", {
        path: { recording: detail.id },
        query: {
          axis: Number(predict),
          ...(by && { profile: Number(by) }),
          ...(settled && { from_s: settled[0], to_s: settled[1] }),
        },
      }),
    enabled: on,
    placeholderData: keepPreviousData,
    staleTime: Number.POSITIVE_INFINITY,
    retry: false,
  });
  const profiles = useQuery({
    queryKey: ["profiles", "of", detail.model],
    queryFn: async () => (await api.GET("/api/v1/profiles")).profiles,
    enabled: on,
  });
  const kept = (profiles.data ?? []).filter(({ model }) => model === detail.model);
  const { data } = query;
  const [whole, setWhole] = useState<Window | null>(null);
  if (data && settled === null && !query.isPlaceholderData && (whole?.[0] !== data.from_s || whole[1] !== data.to_s))
    setWhole([data.from_s, data.to_s]);
  if (axes.length === 0) return null;
  return (
    <Card
      title="Prediction"
      {...(data && { note: data.motions === 1 ? "of one motion" : `of ${data.motions} motions` })}
      actions={
        on ? (
          <>
            {axes.length > 1 && (
              <Select
                w={100}
                aria-label="Axis that is predicted"
                data={axes.map((axis) => ({ value: String(axis), label: `Axis ${axis}` }))}
                value={predict}
                onChange={(axis) => axis && putIntoAddress({ predict: axis }, "replace")}
              />
            )}
            <Select
              w={220}
              aria-label="Settings to predict by"
              data={[
                { value: "", label: AS_RECORDED },
                ...kept.map(({ id, name }) => ({ value: String(id), label: `profile ${name}` })),
              ]}
              value={by}
              onChange={(profile) => putIntoAddress({ by: profile ?? "" }, "replace")}
            />
            <Button variant="subtle" onClick={() => putIntoAddress({ predict: "", by: "" }, "replace")}>
              Close
            </Button>
          </>
        ) : (
          <Button variant="default" onClick={() => putIntoAddress({ predict: String(axes[0]) }, "replace")}>
            Compare with a prediction
          </Button>
        )
      }
    >
      {!on && (
        <Text size="xs" c="dimmed">
          The ramps that the calculators make of the commands in it, by the settings of then or by a profile; and how
          far the motor was from them.
        </Text>
      )}
      <ProblemAlert error={on ? query.error : null} doing="Predicting" />
      {on && data === undefined && query.error === null && (
        <Group justify="center" py="md">
          <Loading size="sm" label="Working the prediction out" />
        </Group>
      )}
      {on && data && (
        <div className="stack gap-8" data-testid="prediction">
          {data.notes.length > 0 && (
            <ul className="indent m-0 caution text-12" aria-label="What is not predicted">
              {data.notes.map((note) => (
                <li key={note}>{note}</li>
              ))}
            </ul>
          )}
          {data.motions > 0 &&
            [false, true].map((difference) => (
              <ComparePlots
                key={String(difference)}
                comparison={data}
                difference={difference}
                differing="measured less predicted"
                whole={whole ?? [data.from_s, data.to_s]}
                window={window}
                onWindow={onWindow}
              />
            ))}
          {data.motions > 0 && <Differences comparison={data} title="Residual" note="measured less predicted" />}
        </div>
      )}
    </Card>
  );
}
