import { queryOptions, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "./client";

/** A chip or module as the catalog lists it: what it is, what it can, and which links lead to it. */
export type Model = Schemas["CatalogEntry"];
export type Capability = Model["capabilities"][number];
/** An axis without how it stands: that comes by a stream of its own (`useStanding`). */
export type Axis = Omit<Schemas["AxisInfo"], "condition" | "referenced" | "ground_truth">;
/** A connected thing, with what the catalog says of its model. */
export type Device = Omit<Schemas["DeviceInfo"], "axes"> & {
  axes: Axis[];
  about: Model;
  /** it answers, and its driver leaves it alone all the same: what its user sends by hand still goes out */
  heldBack: boolean;
};

const CATALOG = queryOptions({
  queryKey: ["catalog"],
  queryFn: () => api.GET("/api/v1/catalog"),
  staleTime: Number.POSITIVE_INFINITY,
});

export function useCatalog() {
  return useQuery(CATALOG);
}

/** What the catalog says of a model by its name, once it is there. */
export function useModel(name: string | undefined): Model | undefined {
  return useCatalog().data?.find((model) => model.name === name);
}

/** All devices, looked at once a second: connection states change by themselves. */
export function useDevices() {
  const queries = useQueryClient();
  return useQuery({
    queryKey: ["devices"],
    queryFn: async () => {
      const [devices, models] = await Promise.all([api.GET("/api/v1/devices"), queries.ensureQueryData(CATALOG)]);
      // one of a register map that another client has just brought along
      if (devices.some(({ model }) => !models.some(({ name }) => name === model)))
        void queries.invalidateQueries(CATALOG);
      return devices.flatMap((device): Device[] => {
        const about = models.find((model) => model.name === device.model);
        const heldBack = device.state === "failed" && device.axes.some((axis) => axis.condition.kind === "cannot_move");
        return about ? [{ ...device, axes: device.axes.map(lasting), about, heldBack }] : [];
      });
    },
    refetchInterval: 1000,
  });
}

/** With what changes in every look while an axis moves, all that shows a device would be drawn anew each second. */
function lasting({ condition: _, referenced: __, ground_truth: ___, ...axis }: Schemas["AxisInfo"]): Axis {
  return axis;
}

/** Whether a device can do that; without a device nothing can. */
export function can(device: Pick<Device, "about"> | undefined, capability: Capability): boolean {
  return device?.about.capabilities.includes(capability) === true;
}

export function useCatalogModel(model: string | undefined) {
  return useQuery({
    queryKey: ["catalog", model],
    queryFn: () => api.GET("/api/v1/catalog/{model}", { path: { model: model ?? "" } }),
    enabled: model !== undefined,
    staleTime: Number.POSITIVE_INFINITY,
  });
}
