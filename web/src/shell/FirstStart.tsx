import { Alert, Progress, Text } from "@mantine/core";
import { IconCpu } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { api } from "../api/client";

/** Above every page while a first start compiles what emulators run on: how far it is, and what works meanwhile. */
export function FirstStart() {
  const health = useQuery({
    queryKey: ["first start"],
    queryFn: async () => (await api.GET("/api/v1/health/details")).compiling,
    refetchInterval: (query) => (query.state.data ? 1000 : false),
    staleTime: Number.POSITIVE_INFINITY,
  });
  const compiling = health.data;
  if (!compiling) return null;
  const { done, total } = compiling;
  return (
    <Alert
      role="status"
      p="sm"
      mb="sm"
      icon={<IconCpu size={20} aria-hidden />}
      title="First start: emulators are made ready for this machine"
      data-testid="first-start"
    >
      <Text size="sm" mb="xs">
        {done} of {total} are there, the rest within a minute or two. All devices work already; until then emulated
        motors may move slower than real ones, and studies of them wait. The next start takes seconds.
      </Text>
      <Progress value={(done / total) * 100} animated aria-label={`${done} of ${total} made ready`} />
    </Alert>
  );
}
