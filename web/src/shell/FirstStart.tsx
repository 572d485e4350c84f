import { useQuery } from "@tanstack/react-query";
import { api } from "../api/client";
import { later } from "../lib/later";

const FirstStartNote = later(() => import("./FirstStartNote").then((part) => part.FirstStartNote), false);

/** Above every page while a first start compiles what emulators run on: how far it is, and what works meanwhile. */
export function FirstStart() {
  const health = useQuery({
    queryKey: ["first start"],
    queryFn: async () => (await api.GET("/api/v1/health/details")).compiling,
    refetchInterval: (query) => (query.state.data === null ? false : 1000), // a server that starts may have refused
    staleTime: Number.POSITIVE_INFINITY,
  });
  return health.data?.total ? <FirstStartNote {...health.data} /> : null;
}
