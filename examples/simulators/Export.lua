-- DCS World for "forcefeel bridge text": append it to Saved Games/DCS/Scripts/Export.lua. It sends the flight 60 times a second;
-- DCS has no call that moves its stick, so its joystick axis comes from the force-feedback device itself.
local socket = require("socket")
local wire, before = socket.udp(), LuaExportAfterNextFrame
wire:settimeout(0)
wire:setpeername("127.0.0.1", 49010)

function LuaExportAfterNextFrame()
    if before then before() end
    local ias, tas, load = LoGetIndicatedAirSpeed(), LoGetTrueAirSpeed(), LoGetAccelerationUnits()
    if ias and tas and load then
        wire:send(string.format("dynamic_pressure=%f true_airspeed=%f angle_of_attack=%f load_factor=%f mach=%f\n",
            0.5 * 1.225 * ias * ias, tas, math.rad(LoGetAngleOfAttack() or 0), load.y, LoGetMachNumber() or 0))
    end
end
